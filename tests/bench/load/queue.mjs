// 5,000 jobs in the queue at once: every one is accepted, in time that does not grow with the queue,
// and every one is done.
import {setTimeout as sleep} from 'node:timers/promises';

import * as meshes from '../../contract/meshes.mjs';
import {startServer} from '../../contract/server.mjs';
import {anonymousKb, figure, kScale, quantile, round, submit, timed} from './measure.mjs';

const kJobs = 5000 * kScale;
const kSenders = 8;

export async function queue(binary) {
  console.log(`${kJobs} queued jobs`);
  const server = await startServer(binary, ['--workers', '2', '--threads', '1', '--max-queue',
                                            '10000', '--log-level', 'warning']);
  const before = anonymousKb(server.pid);
  const times = [];
  const ids = [];
  const begin = performance.now();
  let sent = 0;
  await Promise.all(Array.from({length: kSenders}, async () => {
    while (sent < kJobs) {
      sent += 1;
      const {ms, job} = await submit(server.base, meshes.glb(2), `?resolution=${256 + sent}`);
      times.push(ms);
      ids.push(job.id);
    }
  }));
  const sending = (performance.now() - begin) / 1000;
  const first = times.slice(0, 500);
  const last = times.slice(-500);
  const peak = anonymousKb(server.pid);
  const states = {};
  for (const id of ids) {
    for (;;) {
      const {answer} = await timed(server.base, {path: `/v1/jobs/${id}`});
      const {state} = JSON.parse(answer.body.toString());
      if (!['queued', 'running'].includes(state)) {
        states[state] = (states[state] ?? 0) + 1;
        break;
      }
      await sleep(20);
    }
  }
  const total = (performance.now() - begin) / 1000;
  const figures = [
    figure('accepted a second', round(ids.length / sending, 0), '/s'),
    figure('a submission, p99', round(quantile(times, 0.99)), 'ms'),
    figure('the last 500 to the first 500, medians',
           round(quantile(last, 0.5) / quantile(first, 0.5), 2), '×', 2),
    figure('done a second', round(ids.length / total, 0), '/s'),
    figure('jobs that did not succeed', kJobs - (states.succeeded ?? 0), '', 0),
    figure('memory a job while all wait', round((peak - before) / kJobs, 2), 'kB'),
  ];
  await server.stop();
  return figures;
}

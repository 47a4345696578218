// 500 readers of events beside busy workers: how soon the first byte comes, what a reader costs, and
// whether the probes still answer.
import http from 'node:http';
import {setTimeout as sleep} from 'node:timers/promises';

import {request} from '../../contract/http.mjs';
import {startServer} from '../../contract/server.mjs';
import {
  anonymousKb, figure, kScale, meshOfTenIterationsASecond, probe, quantile, round, submit, timed,
} from './measure.mjs';

const kAtOnce = 25;
const kStreams = Math.max(kAtOnce, 500 * kScale);
const kWatchSeconds = 15 * kScale;
const kTrimmed = 12_000 * kScale;  // ms; the server gives memory back every 10 s

/** Opens a stream; resolves at its first byte. */
function follow(base, job) {
  const begin = performance.now();
  const stream = {firstByteMs: NaN, events: 0};
  return new Promise((resolve, reject) => {
    const call = http.get(new URL(`/v1/jobs/${job}/events`, base), {agent: false}, (answer) => {
      if (answer.statusCode !== 200) return reject(new Error(`a stream got ${answer.statusCode}`));
      answer.on('error', () => {});
      answer.on('data', (piece) => {
        if (Number.isNaN(stream.firstByteMs)) {
          stream.firstByteMs = performance.now() - begin;
          resolve(stream);
        }
        stream.events += piece.toString().split('\nevent:').length - 1;
      });
    });
    call.on('error', reject);
    stream.close = () => call.destroy();
  });
}

async function iterates(base, job) {
  for (;;) {
    const {answer} = await timed(base, {path: `/v1/jobs/${job}`});
    if (JSON.parse(answer.body.toString()).progress?.iteration > 3) return;
    await sleep(50);
  }
}

export async function streams(binary) {
  console.log(`${kStreams} event streams beside busy workers`);
  const server = await startServer(binary, ['--workers', '2', '--threads', '1', '--max-streams',
                                            '1000', '--log-level', 'warning']);
  const mesh = await meshOfTenIterationsASecond(server.base);
  const jobs = [];
  for (let i = 0; i < 2; ++i) {  // two questions: the same one is worked on once
    const query = `?preset=chart&stop.iterations=${10_000 - i}&guarantee=none`;
    jobs.push((await submit(server.base, mesh, query)).job.id);
  }
  for (const job of jobs) await iterates(server.base, job);
  await sleep(kTrimmed);  // now the jobs' memory is taken, and what they have freed is given back
  const before = anonymousKb(server.pid);
  const stopProbe = probe(server.base);
  const open = [];
  for (let i = 0; i < kStreams; i += kAtOnce) {
    open.push(...await Promise.all(
      Array.from({length: kAtOnce}, (_, k) => follow(server.base, jobs[(i + k) % 2]))));
  }
  const seen = open.map(({events}) => events);
  await sleep(1000 * kWatchSeconds);
  const rates = open.map(({events}, i) => (events - seen[i]) / kWatchSeconds);
  const perStream = (anonymousKb(server.pid) - before) / kStreams;
  const probes = await stopProbe();
  const firstBytes = open.map(({firstByteMs}) => firstByteMs);
  const figures = [
    figure('events a second and stream, median', round(quantile(rates, 0.5)), '/s'),
    figure('first byte, median', round(quantile(firstBytes, 0.5)), 'ms'),
    figure('first byte, p99', round(quantile(firstBytes, 0.99)), 'ms', 250),
    figure('/healthz, p99', round(quantile(probes, 0.99)), 'ms', 50),
    figure('memory a stream', round(perStream), 'kB', 40),
  ];
  open.forEach(({close}) => close());
  for (const id of jobs) await request(server.base, {method: 'DELETE', path: `/v1/jobs/${id}`});
  await server.stop();
  return figures;
}

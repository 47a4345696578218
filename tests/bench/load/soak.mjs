// Everything a little, for as long as asked: jobs of many kinds and of ten to seven thousand
// triangles, readers that come and go, bad requests, removals. Memory must not grow: the last third of
// the samples is compared with the second. Jobs are kept for 20 s only: those of an hour would be counted
// as growth (some 3 kB each, of them SQLite's page cache up to its bound of 2 MB).
import {setTimeout as sleep} from 'node:timers/promises';

import {openStream, request} from '../../contract/http.mjs';
import * as meshes from '../../contract/meshes.mjs';
import {startServer} from '../../contract/server.mjs';
import {anonymousKb, figure, kGlb, quantile, round} from './measure.mjs';

const kGrowth = 1.05;
const kUsers = 4;
const kMethods = ['asap', 'arap', 'hybrid&lambda=0.1', 'bff', 'abf', 'slim'];

/** One visit, told apart by its number alone. */
async function visit(base, number) {
  const post = (path, body, headers = kGlb) => request(base, {method: 'POST', path, headers, body});
  const size = number % 17 === 0 ? 40 + 20 * (number % 2) : 2 + (number % 9);
  const method = kMethods[number % kMethods.length];
  const query = `?method=${method}&resolution=${64 + (number % 4000)}`;
  if (number % 11 === 0) await post('/v1/jobs?method=none', meshes.glb(2));
  if (number % 13 === 0) await post('/v1/unwrap', meshes.kRefused.malformed_glb);
  if (number % 5 === 0) return post(`/v1/unwrap${query}`, meshes.glb(size));
  const answer = await post(`/v1/jobs${query}`, meshes.glb(size));
  if (answer.status !== 202) return answer;
  const path = `/v1/jobs/${JSON.parse(answer.body.toString()).id}`;
  const stream = await openStream(base, `${path}/events`);
  await request(base, {path: `${path}/events`});  // ends when the job does
  await request(base, {path: `${path}/result`, headers: {Accept: 'model/obj'}});
  if (number % 3 === 0) await request(base, {path: `${path}/layout.png?size=128`});
  stream.close();
  return request(base, {method: 'DELETE', path});
}

export async function soak(binary, seconds, flags = []) {
  console.log(`a soak of ${seconds} s ${flags.join(' ')}`);
  const server = await startServer(binary, ['--workers', '2', '--threads', '1', '--log-level', 'off',
                                            '--keep-seconds', '20', ...flags]);
  const end = Date.now() + 1000 * seconds;
  let visits = 0;
  let errors = 0;
  const users = Array.from({length: kUsers}, async () => {
    while (Date.now() < end) {
      const {status} = await visit(server.base, visits++).catch(() => ({status: 500}));
      errors += status >= 500 ? 1 : 0;
    }
  });
  const samples = [];
  while (Date.now() < end) {
    await sleep((1000 * seconds) / 90);
    samples.push(anonymousKb(server.pid));
  }
  await Promise.all(users);
  const third = Math.floor(samples.length / 3);
  const middle = quantile(samples.slice(third, 2 * third), 0.5);
  const late = quantile(samples.slice(2 * third), 0.5);
  const verdict = late > kGrowth * middle ? 'growing' : 'flat';
  console.log(`  memory is ${verdict}`);
  const figures = [
    figure('visits', visits, ''),
    figure('answers of 500 and above', errors, '', 0),
    figure('memory, second third', middle, 'kB'),
    figure('memory, last third', late, 'kB'),
    figure('growth', round(late / middle, 3), '×', kGrowth),
  ];
  await server.stop();
  return figures;
}

// What the parts of the load test share: quantiles, the memory of a process, probes while it works.
import {once} from 'node:events';
import {readFileSync} from 'node:fs';
import {Worker} from 'node:worker_threads';

import {request} from '../../contract/http.mjs';
import * as meshes from '../../contract/meshes.mjs';

/** Share of the full numbers of streams, connections, jobs and seconds; 1 is what figures are told of. */
export const kScale = Number(process.env.LOAD_SCALE ?? 1);

export const kGlb = {'Content-Type': 'model/gltf-binary'};

export function quantile(values, q) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))] ?? NaN;
}

export const round = (value, digits = 1) => Number(value.toFixed(digits));

/** Of a process: private memory that is resident, kB. */
export function anonymousKb(pid) {
  return Number(/^RssAnon:\s+(\d+) kB/m.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]);
}

/** Milliseconds that a call takes; rejects unless its status is the one expected. */
export async function timed(base, call, status = 200) {
  const begin = performance.now();
  const answer = await request(base, call);
  if (answer.status !== status) throw new Error(`${call.path}: ${answer.status} ${answer.body}`);
  return {ms: performance.now() - begin, answer};
}

/** Asks for /healthz 20 times a second until stop() is called, which resolves to the times, ms. */
export function probe(base) {
  const prober = new Worker(new URL('./probe.mjs', import.meta.url), {workerData: base});
  const times = once(prober, 'message');  // rejects with what is thrown there
  times.catch(() => {});                  // before anybody asks
  return async () => {
    prober.postMessage('stop');
    return (await times)[0];
  };
}

export async function submit(base, body, query = '', headers = {}) {
  const call = {method: 'POST', path: `/v1/jobs${query}`, headers: {...kGlb, ...headers}, body};
  const {ms, answer} = await timed(base, call, headers.Prefer ? 200 : 202);
  return {ms, job: JSON.parse(answer.body.toString())};
}

/** A mesh of whose plain iterations some ten are done in a second, on this machine as it is. */
export async function meshOfTenIterationsASecond(base) {
  const size = 60;
  const query = '?preset=chart&stop.iterations=40&guarantee=none';
  const {job} = await submit(base, meshes.glb(size), query, {Prefer: 'wait=60'});
  const {answer} = await timed(base, {path: `/v1/jobs/${job.id}/report`});
  const {timings_ms} = JSON.parse(answer.body.toString());
  const faces = (2 * size * size * 100) / (timings_ms.solve / 40);
  return meshes.glb(Math.max(20, Math.min(600, Math.round(Math.sqrt(faces / 2)))));
}

/** One line of a table, and whether what was asked for holds. limit undefined: only told. */
export function figure(name, value, unit, limit) {
  const holds = limit === undefined || value <= limit;
  const asked = limit === undefined ? '' : `  (asked: ${limit} ${unit}) ${holds ? 'ok' : 'MISSED'}`;
  console.log(`  ${name.padEnd(44)}${String(value).padStart(10)} ${unit}${asked}`);
  return {name, value, unit, ...(limit === undefined ? {} : {limit, holds})};
}

// Asks for /healthz 20 times a second, in a thread of its own: what the readers of 500 streams do in
// theirs is not the server's delay.
import {setTimeout as sleep} from 'node:timers/promises';
import {parentPort, workerData} from 'node:worker_threads';

import {timed} from './measure.mjs';

const times = [];
let stopped = false;
parentPort.once('message', () => { stopped = true; });
while (!stopped) {
  times.push((await timed(workerData, {path: '/healthz'})).ms);
  await sleep(50);
}
parentPort.postMessage(times);

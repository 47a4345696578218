// 1,000 connections that ask nothing and 200 that send their headers a byte at a time: others are
// still served.
import net from 'node:net';
import {setTimeout as sleep} from 'node:timers/promises';

import * as meshes from '../../contract/meshes.mjs';
import {startServer} from '../../contract/server.mjs';
import {anonymousKb, figure, kScale, probe, quantile, round, submit} from './measure.mjs';

const kIdle = 1000 * kScale;
const kSlow = 200 * kScale;
const kSeconds = 8 * kScale;

function connect(base, live) {
  const {hostname, port} = new URL(base);
  return new Promise((resolve) => {
    const socket = net.connect(Number(port), hostname, () => resolve(socket));
    socket.on('error', () => resolve(socket));
    socket.on('close', () => live.delete(socket));
    live.add(socket);
  });
}

export async function idle(binary) {
  console.log(`${kIdle} idle and ${kSlow} slow connections`);
  const server = await startServer(binary, ['--workers', '1', '--log-level', 'warning']);
  const before = anonymousKb(server.pid);
  const live = new Set();
  await Promise.all(Array.from({length: kIdle}, () => connect(server.base, live)));
  const slow = await Promise.all(Array.from({length: kSlow}, () => connect(server.base, live)));
  const head = 'GET /v1/limits HTTP/1.1\r\nHost: slow\r\nX-Slow: ';
  let sent = 0;
  const drip = setInterval(() => {
    slow.forEach((socket) => socket.writable && socket.write(head[sent] ?? 'x'));
    sent += 1;
  }, 100);
  await sleep(1000);
  const stopProbe = probe(server.base);
  const jobs = [];
  for (const end = Date.now() + 1000 * kSeconds; Date.now() < end; await sleep(200)) {
    jobs.push((await submit(server.base, meshes.glb(4), '', {Prefer: 'wait=30'})).ms);
  }
  const probes = await stopProbe();
  const figures = [
    figure('/healthz, p99', round(quantile(probes, 0.99)), 'ms', 50),
    figure('a small job from end to end, p99', round(quantile(jobs, 0.99)), 'ms', 1000),
    figure('connections that are still open', live.size, ''),
    figure('memory a connection', round((anonymousKb(server.pid) - before) / (kIdle + kSlow)), 'kB'),
  ];
  clearInterval(drip);
  live.forEach((socket) => socket.destroy());
  await server.stop();
  return figures;
}

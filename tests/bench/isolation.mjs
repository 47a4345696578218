// What a process of its own costs a job (ADR 0037): two servers, one with --isolate=off, do the same
// jobs in turns. Ratios of medians and of minima; processor time is that of a server with the
// processes that it has started. A part of it is spent beside the job, on the start of the process for
// the next. Then what a process spares that has done a job of the mesh before (ADR 0075). Nothing fails:
// machines are noisy.
//
//   node isolation.mjs UNWRAPD OUT.json [REPETITIONS (20) [FILE.obj[,QUERY]...]]
import {readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {loadavg} from 'node:os';
import {basename} from 'node:path';
import {setTimeout as sleep} from 'node:timers/promises';

import * as meshes from '../contract/meshes.mjs';
import {startServer} from '../contract/server.mjs';
import {children} from '../isolate/processes.mjs';
import {figure, quantile, round, timed} from './load/measure.mjs';

const kFlags = ['--admin-listen=off', '--workers=1', '--threads=1', '--solver-cache-bytes=0', '--log-level=off'];
const kAsked = 1.05;     // at 20,000 faces
const kUntilSpare = 80;  // ms after a job: the next process has started, and its time counts
const kWarm = 3;         // jobs that do not count
const kTick = 10;        // ms: the least that the system tells of processor time

const [binary, out, repetitions = '20', ...files] = process.argv.slice(2);
const works = [
  {name: '2 faces', body: meshes.obj(1), query: ''},
  {name: '20,000 faces', body: meshes.obj(100), query: '', asked: kAsked},
  {name: '20,000 faces, bijective', body: meshes.obj(100), query: 'guarantee=bijective', asked: kAsked},
];
const work = (file) => {
  const [path, query = ''] = file.split(',');
  return {name: `${basename(path)} ${query}`, body: readFileSync(path), query};
};

/** Of a server and what it has started and waited for: processor time in ms. */
function processorMs(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/^.*\) /s, '').split(' ');
  return fields.slice(11, 15).reduce((sum, ticks) => sum + Number(ticks) * kTick, 0);
}

/** Of the processes that wait for jobs: what their starts have taken, ms. */
function startsMs(pid) {
  const threads = children(pid).flatMap((child) =>
    readdirSync(`/proc/${child}/task`).map((id) => `/proc/${child}/task/${id}`));
  const ns = threads.map((thread) => Number(readFileSync(`${thread}/schedstat`, 'utf8').split(' ')[0]));
  return ns.reduce((sum, each) => sum + each, 0) / 1e6;
}

/** One job, which no job before it equals. Returns its time in ms. */
async function measured(server, {body, query}, job) {
  const call = {method: 'POST', path: `/v1/unwrap?${query}`, headers: {'Content-Type': 'model/obj'},
                body: Buffer.concat([body, Buffer.from(`\n# ${job}\n`)])};
  const {ms} = await timed(server.base, call);
  await sleep(kUntilSpare);
  return ms;
}

/** Times of jobs on each server in turns: {off, on}, each {times, processor, starts (ms a job)}. */
async function compared(servers, one) {
  const times = {off: [], on: []};
  const before = {};
  let starts = 0;
  for (let job = -kWarm; job < Number(repetitions); job++) {
    if (job === 0) for (const [mode, server] of Object.entries(servers)) before[mode] = processorMs(server.pid);
    for (const mode of job % 2 ? ['off', 'on'] : ['on', 'off']) {
      if (job >= 0) starts += startsMs(servers[mode].pid) / Number(repetitions);
      const ms = await measured(servers[mode], one, job);
      if (job >= 0) times[mode].push(ms);
    }
  }
  const spent = (mode) => processorMs(servers[mode].pid) - before[mode];
  const processor = (mode) => Math.max(kTick, spent(mode)) / Number(repetitions);
  return {off: {times: times.off, processor: processor('off'), starts: 0},
          on: {times: times.on, processor: processor('on'), starts}};
}

function told(one, {off, on}) {
  const ratio = (of) => round(of(on) / of(off), 3);
  const median = ({times}) => quantile(times, 0.5);
  return [
    figure(`${one.name}: median off`, round(median(off)), 'ms'),
    figure(`${one.name}: median on`, round(median(on)), 'ms'),
    figure(`${one.name}: ratio of medians`, ratio(median), 'times', one.asked),
    figure(`${one.name}: ratio of minima`, ratio(({times}) => Math.min(...times)), 'times', one.asked),
    figure(`${one.name}: processor time more`, round(on.processor - off.processor), 'ms a job'),
    figure(`${one.name}: of that the next start`, round(on.starts), 'ms a job'),
    figure(`${one.name}: ratio of processor time`, ratio(({processor}) => processor), 'times'),
    figure(`${one.name}: ratio without that start`, ratio(({processor, starts}) => processor - starts), 'times',
           one.asked),
  ];
}

/** Maps for a slider of lambda: on meshes that nobody has sent, and on one that was sent before. */
async function drafts(server) {
  const times = {anew: [], again: []};
  for (let job = -kWarm; job < Number(repetitions); job++)
    for (const [kind, number] of [['anew', job], ['again', 'the same']]) {
      const query = `preset=chart&method=hybrid&guarantee=none&stop.iterations=10&lambda=${(job + kWarm + 1) / 100}`;
      const ms = await measured(server, {body: meshes.obj(100), query}, `draft ${number}`);
      if (job >= 0) times[kind].push(ms);
    }
  const median = (kind) => quantile(times[kind], 0.5);
  return [
    figure('another lambda at 20,000 faces: mesh not seen before', round(median('anew')), 'ms'),
    figure('another lambda at 20,000 faces: mesh seen before', round(median('again')), 'ms'),
    figure('another lambda at 20,000 faces: ratio of medians', round(median('again') / median('anew'), 3), 'times'),
  ];
}

const servers = {off: await startServer(binary, [...kFlags, '--isolate=off']),
                 on: await startServer(binary, [...kFlags, '--isolate=on'])};
const figures = [];
try {
  for (const one of files.length > 0 ? files.map(work) : works)
    figures.push(...told(one, await compared(servers, one)));
  if (files.length === 0) figures.push(...await drafts(servers.on));
} finally {
  await Promise.all(Object.values(servers).map((server) => server.stop()));
}
figures.push(figure('load of the machine', round(loadavg()[0], 2), ''));
writeFileSync(out, JSON.stringify({date: new Date().toISOString(), figures}, null, 2) + '\n');

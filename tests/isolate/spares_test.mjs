// Worker processes that wait for their jobs: what they may is bounded before a job comes, each is for
// one job, or for those of one mesh and owner, and what becomes of them while they wait is held against
// none. UNWRAPD names the server of misbehaving_main.cpp.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import test, {after, before} from 'node:test';
import {setTimeout as sleep} from 'node:timers/promises';

import {request} from '../contract/http.mjs';
import * as meshes from '../contract/meshes.mjs';
import {startServer, withServer} from '../contract/server.mjs';
import {busyWorker, children, hasEnded, heldMemory, niceness, spares} from './processes.mjs';

const kWorkers = 2;
const kFlags = ['--isolate', '--workers', String(kWorkers), '--threads', '3', '--memory-limit', '200000000',
                '--max-job-seconds', '40'];
const kMegabyte = 1024 * 1024;

let server;
before(async () => (server = await startServer(process.env.UNWRAPD, kFlags)));
after(() => server.stop());

const waiting = () => spares(server.pid, kWorkers);

/** Sends an OBJ as a job and resolves to the job once it is final. */
async function done(body) {
  const headers = {'Content-Type': 'model/obj', Prefer: 'wait=60'};
  const answer = await request(server.base, {method: 'POST', path: '/v1/jobs', headers, body});
  assert.equal(answer.status, 200, answer.body.toString());
  return JSON.parse(answer.body.toString());
}

let count = 0;

/** A mesh that no job has had: a repeated job takes no process. */
const another = () => Buffer.concat([Buffer.from(`# ${++count}\n`), meshes.obj()]);

/** Does a job, and resolves to the process that has done it. */
async function processOfAJob() {
  const job = await done(Buffer.concat([Buffer.from('# do tell_process\n'), another()]));
  assert.equal(job.problem.code, 'solver_failed');
  return job.problem.detail;
}

test('a process waits for each worker, with the bounds that its job will have', async () => {
  for (const pid of await waiting()) {
    const limits = readFileSync(`/proc/${pid}/limits`, 'utf8');
    const of = (what) => limits.match(new RegExp(`^${what} +(\\S+) +(\\S+)`, 'm')).slice(1).map(Number);
    const memory = 200_000_000 + (128 + 256 + 3 * 80) * kMegabyte;
    assert.deepEqual(of('Max address space'), [memory, memory]);
    assert.deepEqual(of('Max cpu time'), [300, 301]);
    assert.deepEqual(of('Max open files'), [3, 3]);
    assert.deepEqual(of('Max file size'), [0, 0]);
    assert.match(readFileSync(`/proc/${pid}/status`, 'utf8'), /^NoNewPrivs:\s+1$/m);
    assert.equal(readFileSync(`/proc/${pid}/oom_score_adj`, 'utf8'), '1000\n');
    assert.equal(niceness(pid), Math.min(niceness(server.pid) + 10, 19), 'work on meshes yields to answers');
  }
});

test('a job is done by a process that waited, and each by another', async () => {
  const used = new Set();
  for (let job = 1; job <= 4; job++) {
    const ready = await waiting();
    const pid = await processOfAJob();
    assert.ok(ready.includes(pid), `${pid} is none of ${ready}`);
    assert.equal(used.has(pid), false);
    used.add(pid);
  }
});

test('a file is made by a process that waited; the next waits longer than the thread that wanted it', async () => {
  const {id} = await done(another());
  const before = await waiting();
  const answer = await request(server.base, {path: `/v1/jobs/${id}/preview.png?size=64`});
  assert.equal(answer.status, 200);
  const later = await waiting();
  assert.equal(later.filter((pid) => before.includes(pid)).length, kWorkers - 1);
  for (let job = 1; job <= kWorkers; job++) assert.ok(later.includes(await processOfAJob()));
});

const kWork = {
  job: async () => assert.equal((await done(another())).state, 'succeeded'),
  file: async () => {
    const {id} = await done(another());
    assert.equal((await request(server.base, {path: `/v1/jobs/${id}/layout.png`})).status, 200);
  },
};

for (const [work, doIt] of Object.entries(kWork))
  for (const signal of ['SIGKILL', 'SIGTERM'])
    test(`a process that ends by ${signal} while it waits is not held against a ${work}`, async () => {
      const doomed = await waiting();
      for (const pid of doomed) process.kill(Number(pid), signal);
      while (!doomed.every(hasEnded)) await sleep(5);
      for (let time = 1; time <= kWorkers; time++) await doIt();
      assert.doesNotMatch(server.log(), /a worker process ended/);
    });

test('a process that waits holds the memory of a large job, once there was one, and no more', async (t) => {
  const other = await startServer(process.env.UNWRAPD, kFlags);
  t.after(() => other.stop());
  const [fresh] = await spares(other.pid, kWorkers);
  assert.ok(heldMemory(fresh) < 8 * kMegabyte);
  const headers = {'Content-Type': 'model/obj', Prefer: 'wait=60'};
  const sent = {method: 'POST', path: '/v1/jobs', headers, body: meshes.obj(100)};
  assert.equal(JSON.parse((await request(other.base, sent)).body.toString()).state, 'succeeded');
  await request(other.base, {...sent, body: meshes.obj()});  // the process after it knows of it
  const later = (await spares(other.pid, kWorkers)).at(-1);
  while (heldMemory(later) < 16 * kMegabyte) await sleep(5);
  assert.ok(heldMemory(later) < 48 * kMegabyte);
});

/** A server of a test's own, and what sends it one mesh in jobs of which no two agree. */
async function manyJobs(t, flags = kFlags, body = another()) {
  const own = await startServer(process.env.UNWRAPD, flags);
  t.after(() => own.stop());
  let padding = 0;
  const send = async (more = {}, query = '') => {
    const headers = {'Content-Type': 'model/obj', Prefer: 'wait=60', ...more};
    const path = `/v1/jobs?padding=${++padding}${query}`;
    const answer = await request(own.base, {method: 'POST', path, headers, body});
    assert.equal(answer.status, 200, answer.body.toString());
    return JSON.parse(answer.body.toString());
  };
  const result = async ({id}) => (await request(own.base, {path: `/v1/jobs/${id}/result`})).body;
  return {own, body, send, result};
}

/** No process of a server waits for another job of its mesh: one that does ends after half a minute, too. */
async function nothingIsKept(pid) {
  const begun = Date.now();
  await spares(pid, kWorkers);
  assert.ok(Date.now() - begun < 20_000, 'a process has waited for another job of its mesh');
}

/** Sends a mesh twice; resolves to the process that then waits for its third job: the oldest. */
async function keptBy({own, send}, more) {
  await send(more);
  await nothingIsKept(own.pid);  // most meshes are sent once
  await send(more);
  return (await spares(own.pid, kWorkers + 1))[0];
}

test('a process does all further jobs of a mesh that comes again, with the bytes of any other', async (t) => {
  const many = await manyJobs(t);
  const kept = await keptBy(many);
  const before = children(many.own.pid);
  const results = [];
  for (let k = 0; k < 3; k++) results.push(await many.result(await many.send()));
  assert.deepEqual(children(many.own.pid), before, 'no process was started, and none has ended');
  process.kill(Number(kept), 'SIGKILL');  // not held against the next job
  while (!hasEnded(kept)) await sleep(5);
  assert.equal((await many.send()).state, 'succeeded');
  assert.doesNotMatch(many.own.log(), /a worker process ended/);
  const other = await manyJobs(t, ['--isolate=off', ...kFlags.slice(1)], many.body);
  for (let k = 0; k < 2; k++) await other.send();
  for (const result of results) assert.ok(result.equals(await other.result(await other.send())));
});

test('a job with lists has a process of its own, and one that a job has started does no other', async (t) => {
  const many = await manyJobs(t);
  const pin = encodeURIComponent(JSON.stringify([{vertex: 0, uv: [0, 0]}]));
  for (let k = 0; k < 3; k++)
    assert.equal((await many.send({}, `&preset=chart&guarantee=none&constraints=${pin}`)).state, 'succeeded');
  await nothingIsKept(many.own.pid);
  for (let round = 0; round < 3; round++) {
    const gone = await spares(many.own.pid, kWorkers);
    for (const pid of gone) process.kill(Number(pid), 'SIGKILL');
    while (!gone.every(hasEnded)) await sleep(5);
    for (let k = 0; k < kWorkers; k++) await many.send();  // each starts its process itself
  }
  await nothingIsKept(many.own.pid);
});

test('a process does no other job where one was slow', async (t) => {
  const many = await manyJobs(t, kFlags, meshes.obj(60));
  for (let k = 0; k < 2; k++) {
    const sent = many.send({}, '&preset=paper&stop.iterations=10000');
    const worker = Number(await busyWorker(many.own.pid));
    process.kill(worker, 'SIGSTOP');  // slow on any machine
    await sleep(2100);
    process.kill(worker, 'SIGCONT');
    assert.equal((await sent).state, 'succeeded');
  }
  await nothingIsKept(many.own.pid);
});

test('what lies in the socket of a process that has not read it is not held against the job', async (t) => {
  const many = await manyJobs(t);
  const frozen = await spares(many.own.pid, kWorkers);
  for (const pid of frozen) process.kill(Number(pid), 'SIGSTOP');
  const sent = many.send();
  while (!many.own.log().includes('"event":"job started"')) await sleep(5);
  await sleep(500);  // all of it is sent
  for (const pid of frozen) process.kill(Number(pid), 'SIGKILL');
  assert.deepEqual([(await sent).state, (await sent).attempt], ['succeeded', 1]);
  assert.doesNotMatch(many.own.log(), /a worker process ended/);
});

test('a process that runs out of processor time tells so, and is not tried again', async (t) => {
  const many = await manyJobs(t, kFlags, meshes.obj(100));
  const sent = many.send({}, '&preset=paper&stop.iterations=10000');
  process.kill(Number(await busyWorker(many.own.pid)), 'SIGXCPU');
  assert.deepEqual([(await sent).problem.code, (await sent).attempt], ['time_limit', 1]);
});

test('a process that has failed a job, or was stopped, does no other', async (t) => {
  const many = await manyJobs(t);
  const kept = await keptBy(many);
  const failed = await many.send({}, '&resolution=16&max_pages=1&texels_per_unit=1000');
  assert.equal(failed.problem.code, 'does_not_fit');
  while (!hasEnded(kept)) await sleep(5);
  await nothingIsKept(many.own.pid);
});

test('no process does the jobs of another owner', async (t) => {
  const many = await manyJobs(t, [...kFlags, '--require-keys']);
  const holder = (name) => {
    const words = ['keys', 'add', '--name', name, '--data', many.own.data];
    const [, key] = /^(unw_\S+)$/m.exec(execFileSync(process.env.UNWRAPD, words, {encoding: 'utf8'}));
    return {Authorization: `Bearer ${key}`};
  };
  const [one, other] = ['one', 'other'].map(holder);
  const kept = await keptBy(many, one);
  process.kill(Number(kept), 'SIGSTOP');  // whoever gets it waits
  for (let k = 0; k < 3; k++) assert.equal((await many.send(other)).state, 'succeeded');
  process.kill(Number(kept), 'SIGCONT');
});

test('a process waits half a minute for the next job of its mesh', async (t) => {
  const many = await manyJobs(t);
  const kept = await keptBy(many);
  const begun = Date.now();
  while (!hasEnded(kept)) await sleep(100);
  assert.ok(Date.now() - begun > 20_000);
  assert.equal((await spares(many.own.pid, kWorkers)).includes(kept), false);
});

test('no process outlives its server', async () => {
  let left;
  await withServer(process.env.UNWRAPD, kFlags,
                   async ({pid}) => (left = await spares(pid, kWorkers)));
  assert.deepEqual(left.filter((pid) => !hasEnded(pid)), []);
});

test('no process outlives a server that is killed', async (t) => {
  const other = await startServer(process.env.UNWRAPD, kFlags);
  t.after(() => other.stop());
  const left = await spares(other.pid, kWorkers);
  process.kill(other.pid, 'SIGKILL');
  while (!left.every(hasEnded)) await sleep(5);
});

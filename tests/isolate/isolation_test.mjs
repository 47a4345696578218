// --isolate: whatever a worker process does, one job pays for it, and nothing else. UNWRAPD names the
// server of misbehaving_main.cpp.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {createHash} from 'node:crypto';
import {existsSync, readFileSync} from 'node:fs';
import {join} from 'node:path';
import test, {after, before} from 'node:test';
import {setTimeout as sleep} from 'node:timers/promises';

import {newId} from '../contract/cases/shared.mjs';
import {multipart, request} from '../contract/http.mjs';
import * as meshes from '../contract/meshes.mjs';
import {startServer} from '../contract/server.mjs';
import {parseEvents} from '../contract/spec.mjs';
import {dataDirectory, ENDLESS, Server} from '../fault/server.mjs';
import {busyWorker, children, hasEnded, spares} from './processes.mjs';

const kObj = {'Content-Type': 'model/obj'};

let isolated;
let plain;
before(async () => {
  [isolated, plain] = await Promise.all([
    startServer(process.env.UNWRAPD, ['--isolate', '--workers', '2', '--threads', '2',
                                       '--grace-seconds', '1', '--memory-limit', '200000000']),
    startServer(process.env.UNWRAPD, ['--isolate=off', '--workers', '1', '--threads', '2']),
  ]);
});
after(() => Promise.all([isolated.stop(), plain.stop()]));

/** Sends an OBJ as a job and returns the job once it is final. */
async function done(server, body, query = '') {
  const headers = {...kObj, Prefer: 'wait=60'};
  const answer = await request(server.base, {method: 'POST', path: `/v1/jobs${query}`, headers, body});
  assert.equal(answer.status, 200, answer.body.toString());
  return JSON.parse(answer.body.toString());
}

const doing = (what) => Buffer.concat([Buffer.from(`# do ${what}\n`), meshes.obj()]);
const drawing = (what) => Buffer.concat([Buffer.from(`# draw ${what}\n`), meshes.obj()]);

async function get(server, path, headers) {
  const answer = await request(server.base, {path, headers});
  assert.equal(answer.status, 200, `${path}: ${answer.body}`);
  return answer.body;
}

test('a job in a process of its own gives the same answer', async () => {
  const query = '?method=hybrid&lambda=1,0.01&output=glb&compression=draco';
  const [one, other] = await Promise.all(
    [isolated, plain].map((server) => done(server, meshes.obj(12), query)));
  assert.equal(one.state, 'succeeded');
  for (const path of ['result', 'result?lambda=0.01', 'layout.svg', 'layout.svg?colour=area',
                      'layout.png?size=64', 'preview.png?size=64&lambda=0.01']) {
    assert.deepEqual(await get(isolated, `/v1/jobs/${one.id}/${path}`),
                     await get(plain, `/v1/jobs/${other.id}/${path}`), path);
  }
  const figures = async (server, {id}) => {
    const report = JSON.parse(await get(server, `/v1/jobs/${id}/report`));
    return {...report, timings_ms: Object.keys(report.timings_ms)};
  };
  assert.deepEqual(await figures(isolated, one), await figures(plain, other));
  const events = async (server, {id}) =>
    parseEvents((await get(server, `/v1/jobs/${id}/events`)).toString())
      .filter(({event}) => ['stage', 'iteration', 'note'].includes(event))
      .map(({event, data}) => ({event, ...data, ms: 0}));
  const story = await events(isolated, one);
  assert.deepEqual(story, await events(plain, other));
  assert.ok(story.some(({event, code}) => event === 'note' && code === 'positions_rounded'));
});

test('what is wrong with a mesh is told as ever', async () => {
  for (const face of ['f 1 2 9', 'f 1 2 \x80', 'f 1 2 ' + 'x'.repeat(100_000)]) {
    const bad = Buffer.from(`v 0 0 0\nv 1 0 0\nv 0 1 0\n${face}\n`, 'latin1');
    const [one, other] = await Promise.all([isolated, plain].map((server) => done(server, bad)));
    assert.equal(one.problem.code, 'malformed_obj');
    assert.deepEqual({...one.problem, job: ''}, {...other.problem, job: ''});
  }
});

// The last lines are lies: what they say is nothing that work on a mesh can come to.
const kCrashes = ['segv', 'abort', 'leave', 'connect', 'fork', 'exec', 'traverse', 'overwrite',
                  'threads', 'end_within', 'files', 'twice', 'publish', 'head', 'chatter',
                  'storage_full', 'draining', 'unauthorized', 'time_limit', 'no_such_code'];

for (const what of kCrashes) {
  test(`a worker that does ${what} costs its job alone`, async () => {
    const [bad, good] = await Promise.all([done(isolated, doing(what)), done(isolated, meshes.obj())]);
    assert.deepEqual([bad.state, bad.problem.code], ['failed', 'poison']);
    assert.equal(good.state, 'succeeded');
    await get(isolated, '/v1/methods');
    assert.equal(existsSync(join(isolated.data, 'blobs', 'escaped')), false);
    assert.equal((await done(isolated, meshes.obj(5), '?resolution=99')).state, 'succeeded');
    assert.equal(isolated.log().match(/a worker process ended/g).length % 3, 0);
  });
}

const kRenderings = [['layout.png', 'image/png'], ['preview.png', 'image/png'],
                     ['layout.svg', 'image/svg+xml'], ['result', 'application/json'],
                     ['result', 'model/gltf-binary']];

for (const what of ['segv', 'abort', 'connect', 'chatter']) {
  test(`a worker that does ${what} while a file is made costs that request alone`, async () => {
    const job = await done(isolated, drawing(what));
    assert.equal(job.state, 'succeeded');
    for (const [path, type] of kRenderings) {
      const answer = await request(isolated.base, {path: `/v1/jobs/${job.id}/${path}`, headers: {Accept: type}});
      const problem = JSON.parse(answer.body.toString());
      assert.deepEqual([answer.status, problem.code], [500, 'internal'], `${path}: ${answer.body}`);
      if (what !== 'chatter') assert.match(problem.detail, /^The process that made this file ended/);
    }
    for (const path of ['', '/result', '/report']) await get(isolated, `/v1/jobs/${job.id}${path}`);
    assert.equal((await done(isolated, meshes.obj())).state, 'succeeded');
  });
}

for (const [what, status, code] of [['segv', 500, 'internal'], ['chatter', 500, 'internal'],
                                    ['memory', 200, 'memory_limit'], ['none', 200, undefined]]) {
  test(`a worker that does ${what} while a mesh is looked at costs that request alone`, async () => {
    const body = drawing(what);
    const path = `/v1/meshes/${createHash('sha256').update(body).digest('hex')}`;
    assert.equal((await request(isolated.base, {method: 'PUT', path, headers: kObj, body})).status, 201);
    const answer = await request(isolated.base, {path});
    const seen = JSON.parse(answer.body.toString());
    assert.deepEqual([answer.status, (seen.problem ?? seen).code], [status, code], answer.body.toString());
    if (what !== 'none') return;
    await request(plain.base, {method: 'PUT', path, headers: kObj, body});
    assert.deepEqual(seen.analysis, JSON.parse((await get(plain, path)).toString()).analysis);
  });
}

test('a worker has bounded memory while a file is made', async () => {
  const job = await done(isolated, drawing('memory'));
  const answer = await request(isolated.base, {path: `/v1/jobs/${job.id}/preview.png`});
  assert.deepEqual([answer.status, JSON.parse(answer.body.toString()).code], [422, 'memory_limit']);
});

test('a worker has bounded time while a file is made', async (t) => {
  const server = await startServer(process.env.UNWRAPD, ['--isolate', '--workers', '1', '--max-job-seconds', '1',
                                                          '--grace-seconds', '0']);
  t.after(() => server.stop());
  const job = await done(server, drawing('hang'));
  const answer = await request(server.base, {path: `/v1/jobs/${job.id}/preview.png`});
  assert.deepEqual([answer.status, JSON.parse(answer.body.toString()).code], [422, 'time_limit']);
});

test('a worker has bounded memory', async () => {
  const job = await done(isolated, doing('memory'));
  assert.deepEqual([job.state, job.problem.code], ['failed', 'memory_limit']);
});

for (const what of ['signal', 'look']) {
  test(`a worker reaches no other process: ${what}`, async (t) => {
    const victim = spawn('sleep', ['1000']);
    t.after(() => victim.kill('SIGKILL'));
    const body = Buffer.concat([Buffer.from(`# do ${what}\n# victim ${victim.pid}\n`), meshes.obj()]);
    const job = await done(isolated, body);
    assert.deepEqual([job.state, job.problem.code], ['failed', 'poison']);
    assert.deepEqual([victim.exitCode, victim.signalCode], [null, null]);
  });
}

for (const what of ['open', 'inherit', 'environment']) {
  test(`a worker finds nothing: ${what}`, async () => {
    const job = await done(isolated, doing(what));
    assert.deepEqual([job.problem.code, job.problem.detail], ['solver_failed', 'It is closed.']);
  });
}

/** Sends an OBJ as a job; resolves to its id once its process has begun it. */
async function running(server, body) {
  const answer = await request(server.base, {method: 'POST', path: '/v1/jobs', headers: kObj, body});
  const {id} = JSON.parse(answer.body.toString());
  while (!((await job(server, id)).progress?.fraction > 0)) await sleep(5);
  return id;
}

const job = async (server, id) => JSON.parse(await get(server, `/v1/jobs/${id}`));

for (const what of ['stay', 'flood']) {
  test(`a worker that does ${what} when it is asked to stop is killed`, async () => {
    const id = await running(isolated, doing(what));
    assert.equal((await request(isolated.base, {method: 'DELETE', path: `/v1/jobs/${id}`})).status, 202);
    const told = Date.now();
    while ((await job(isolated, id)).state === 'running') {
      assert.ok(Date.now() < told + 60_000, 'a worker outruns its stop');
      await sleep(20);
    }
    assert.equal((await job(isolated, id)).state, 'cancelled');
    assert.match(isolated.log(), new RegExp(`does not stop, and its process is killed.*${id}`));
  });
}

test('when memory runs out, a worker goes before its server', async () => {
  const id = await running(isolated, doing('stay'));
  const weight = (pid) => Number(readFileSync(`/proc/${pid}/oom_score_adj`, 'utf8'));
  while (children(isolated.pid).length === 0) await sleep(5);
  const [worker] = children(isolated.pid);
  while (weight(worker) === weight(isolated.pid)) await sleep(5);
  assert.equal(weight(worker), 1000);
  await request(isolated.base, {method: 'DELETE', path: `/v1/jobs/${id}`});
});

test('a buffer may have a name of any length that a form may', async () => {
  const name = 'a'.repeat(5000);
  const {text, buffer} = meshes.gltf(name);
  const form = multipart([
    {name: 'mesh', filename: 'grid.gltf', type: 'model/gltf+json', body: text},
    {name: 'buffer', filename: name, type: 'application/octet-stream', body: buffer},
  ]);
  const [one, other] = await Promise.all([isolated, plain].map(async (server) => {
    const headers = {...form.headers, Prefer: 'wait=60'};
    const answer = await request(server.base, {method: 'POST', path: '/v1/jobs', headers, body: form.body});
    return JSON.parse(answer.body.toString());
  }));
  assert.deepEqual([one.state, other.state], ['succeeded', 'succeeded']);
});

test('somebody else who ends a worker cancels no job', async () => {
  const {body} = await request(isolated.base, {
    method: 'POST', path: '/v1/jobs?stop.iterations=10000', headers: kObj, body: meshes.obj(100)});
  const {id} = JSON.parse(body.toString());
  const job = async () => JSON.parse(await get(isolated, `/v1/jobs/${id}`));
  while (!((await job()).progress?.iteration > 0)) await sleep(5);
  const worker = await busyWorker(isolated.pid);
  process.kill(Number(worker), 'SIGTERM');
  while (!hasEnded(worker)) await sleep(5);
  assert.notEqual(await busyWorker(isolated.pid), worker);
  assert.equal((await job()).state, 'running');
  await request(isolated.base, {method: 'DELETE', path: `/v1/jobs/${id}`});
});

test('no process is left when no job is but one for each worker that waits', () => spares(isolated.pid, 2));

/** Sends a mesh that ends the server it is sent to; resolves to its job's id once that is done. */
async function kill(server, what) {
  const id = newId();  // of our own: the server may end before it has answered
  await fetch(`${server.url}/v1/jobs/${id}`, {method: 'PUT', headers: kObj, body: doing(what)}).catch(() => {});
  assert.deepEqual(await server.exited, [null, 'SIGSEGV']);
  return id;
}

test('without --isolate a mesh ends the server once, and its neighbour is not blamed', async (t) => {
  const data = dataDirectory(t);
  const first = await Server.start(data, '--isolate=off', '--workers', '2');
  const neighbour = await first.submit(...ENDLESS);
  await first.iterates(neighbour);
  const guilty = await kill(first, 'segv');
  const second = await Server.start(data, '--isolate=off', '--workers', '2');
  const job = await second.finished(guilty);
  assert.deepEqual([job.state, job.problem.code, job.attempt], ['failed', 'poison', 2]);
  assert.equal((await second.iterates(neighbour)).attempt, 2);
  await second.end('SIGKILL');
});

test('processes that a job has ended count over the death of the server', async (t) => {
  const data = dataDirectory(t);
  const endWorker = async (server) => {
    const worker = await busyWorker(server.process.pid);
    process.kill(Number(worker), 'SIGKILL');
    while (!hasEnded(worker)) await sleep(5);
  };
  const first = await Server.start(data, '--isolate', '--log-level', 'warning');
  const id = await first.submit(...ENDLESS);
  for (let end = 1; end <= 2; end++) {
    await first.iterates(id);
    await endWorker(first);
    while (first.log.split('a worker process ended').length - 1 < end) await sleep(5);
  }
  await first.end('SIGKILL');
  const second = await Server.start(data, '--isolate');
  await second.iterates(id);
  await endWorker(second);
  const job = await second.finished(id);
  assert.deepEqual([job.state, job.problem.code, job.attempt], ['failed', 'poison', 2]);
  await second.end('SIGTERM');
});

test('where there are no worker processes, three deaths of the server are held against a job', async (t) => {
  const data = dataDirectory(t);
  const alone = () => Server.startIn({NO_WORKER: '1'}, data);
  const guilty = await kill(await alone(), 'segv');
  for (let death = 2; death <= 3; death++) {
    const server = await alone().catch(() => undefined);  // it may end before it is listened to
    if (server) await server.exited;
  }
  const last = await alone();
  const job = await last.job(guilty);
  assert.deepEqual([job.state, job.problem.code, job.attempt], ['failed', 'poison', 3]);
  assert.equal(existsSync(join(data, 'blobs', guilty)), false);
  await last.end('SIGTERM');
});

// What is thrown in a worker process and nobody foresaw: the log tells it as it does without such
// processes, the owner of the job learns nothing of it. UNWRAPD names the server of misbehaving_main.cpp.
import assert from 'node:assert/strict';
import test, {after, before} from 'node:test';
import {setTimeout as sleep} from 'node:timers/promises';

import {request} from '../contract/http.mjs';
import * as meshes from '../contract/meshes.mjs';
import {startServer} from '../contract/server.mjs';

const servers = {};
before(async () => {
  servers.isolated = await startServer(process.env.UNWRAPD, ['--isolate', '--workers', '1']);
  servers.plain = await startServer(process.env.UNWRAPD, ['--isolate=off', '--workers', '1']);
});
after(() => Promise.all(Object.values(servers).map((server) => server.stop())));

/** Sends a mesh that says when to throw; returns its job once it is final. */
async function done(server, when) {
  const body = Buffer.concat([Buffer.from(`# ${when} throw\n`), meshes.obj()]);
  const headers = {'Content-Type': 'model/obj', Prefer: 'wait=60'};
  const answer = await request(server.base, {method: 'POST', path: '/v1/jobs', headers, body});
  assert.equal(answer.status, 200, answer.body.toString());
  assert.doesNotMatch(answer.body.toString(), /secret/);
  return JSON.parse(answer.body.toString());
}

/** The lines of what was thrown, once there are so many: an answer may come before its lines. */
async function secrets(server, count) {
  const lines = () => server.log().split('\n').filter((line) => line.includes('the secret of'));
  for (let tries = 0; lines().length < count && tries < 1000; tries += 1) await sleep(10);
  return lines();
}

for (const name of ['isolated', 'plain']) {
  test(`in a job (${name})`, async () => {
    const {id, state, problem} = await done(servers[name], 'do');
    assert.deepEqual([state, problem.code, problem.detail], ['failed', 'internal', 'An internal error occurred.']);
    const lines = await secrets(servers[name], 1);
    assert.equal(lines.length, 1, servers[name].log());
    assert.ok(lines[0].includes('unhandled exception') && lines[0].includes(id), lines[0]);
  });

  test(`while a file is made (${name})`, async () => {
    const {id, state} = await done(servers[name], 'draw');
    assert.equal(state, 'succeeded');
    const answer = await request(servers[name].base, {path: `/v1/jobs/${id}/preview.png`});
    assert.deepEqual([answer.status, JSON.parse(answer.body.toString()).code], [500, 'internal']);
    assert.doesNotMatch(answer.body.toString(), /secret/);
    assert.equal((await secrets(servers[name], 2)).length, 2, servers[name].log());
  });
}

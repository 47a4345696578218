// The codes of a server that asks for keys, calls no webhook, or has a storage that fails.
import {execFileSync} from 'node:child_process';
import {renameSync, rmSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

import {digest, kOfMesh, kSubmissions, newId, ofNoMesh} from './cases/shared.mjs';
import * as meshes from './meshes.mjs';
import {withServer} from './server.mjs';

const kGlb = {'Content-Type': 'model/gltf-binary', 'Cache-Control': 'no-cache'};

const kBodies = [...kSubmissions, 'putMesh'];
const kLong = {materials: ['x'.repeat(100_000)]};  // JSON that is spooled to disk

/** Calls an operation, with a mesh where it takes one; the answer must be this refusal. */
async function refused(run, base, {id = 'createJob', headers, status, code}) {
  const sent = id === kOfMesh ? ofNoMesh(kLong) : kBodies.includes(id) ? {headers: kGlb, body: meshes.glb()} : {};
  const problem = await run.json(base, id, {
    job: newId(), sha256: digest(sent.body ?? ''), status, ...sent, headers: {...sent.headers, ...headers},
  });
  run.expectEqual(`${id}, refused as ${code}`, problem.code, code);
}

/** The operations that need a key where keys are asked for. */
const keyed = (run) => run.contract.operations().filter(({responses}) => responses['401']);

/** The others, which anybody may call. */
const open = (run) => run.contract.operations().filter(({responses}) => !responses['401']);

/** The header fields of the holder of a new key. */
function holder(binary, data, name, ...flags) {
  const args = ['keys', 'add', '--data', data, '--name', name, ...flags];
  const key = execFileSync(binary, args, {stdio: ['ignore', 'pipe', 'ignore']}).toString().trim();
  return {Authorization: `Bearer ${key}`};
}

export function keys(run, binary) {
  return withServer(binary, ['--workers', '1', '--require-keys'], async ({base, data}) => {
    const add = (...args) => holder(binary, data, ...args);
    const [looks, sends, seldom] = [add('looks', '--scopes', 'read'), add('sends', '--scopes', 'submit'),
                                    add('seldom', '--requests-per-minute', '1')];
    await run.call(base, 'listJobs', {headers: seldom, status: 200});
    for (const {id, method} of keyed(run)) {
      const call = (headers, status, code) => refused(run, base, {id, headers, status, code});
      await call({}, 401, 'unauthorized');
      await call(method === 'GET' ? sends : looks, 403, 'forbidden');
      await call(seldom, 429, 'rate_limited');
    }
    for (const {id} of open(run)) await run.call(base, id, {name: `${id} without a key`});
    const poor = add('poor', '--max-bytes', '10');
    for (const id of [...kBodies, kOfMesh]) {
      await refused(run, base, {id, headers: poor, status: 507, code: 'quota_exceeded'});
    }
    const single = add('single', '--max-jobs', '1');
    const {id: job} = await run.json(base, 'createJob', {
      query: {'stop.iterations': 10_000}, headers: {...kGlb, ...single}, body: meshes.glb(150), status: 202,
    });
    await refused(run, base, {headers: single, status: 429, code: 'too_many_jobs'});
    await run.call(base, 'deleteJob', {job, headers: single, status: 202});
  });
}

export function webhookOfNobody(run, binary) {
  return withServer(binary, ['--workers', '1'], ({base}) => refused(run, base, {
    headers: {'Unwrapd-Webhook': 'https://example.com/'}, status: 422, code: 'webhook_refused',
  }));
}

export function brokenStorage(run, binary) {
  return withServer(binary, ['--workers', '1'], async ({base, data}) => {
    const [folder, away] = ['incoming', 'away'].map((name) => join(data, name));
    renameSync(folder, away);
    writeFileSync(folder, 'no folder');
    await refused(run, base, {status: 500, code: 'storage_failed'});
    rmSync(folder);
    renameSync(away, folder);
    await run.call(base, 'createJob', {headers: {...kGlb, Prefer: 'wait=30'}, body: meshes.glb(), status: 200});
  });
}

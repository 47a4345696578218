// Meshes that are stored and made jobs of, by name.
import {raw} from '../http.mjs';
import * as meshes from '../meshes.mjs';
import {digest, kGlb, kOfMesh, kSubmissions, newId} from './shared.mjs';

const kJson = {'Content-Type': 'application/json', Prefer: 'wait=30'};

const put = (run, base, body, headers, status) =>
  run.call(base, 'putMesh', {sha256: digest(body), headers, body, status});

export async function storedMeshes(run, base) {
  const body = meshes.glb(5);
  const sha256 = digest(body);
  await run.call(base, 'getMesh', {sha256, status: 404});
  const stored = await put(run, base, body, kGlb, 201);
  run.expectEqual('its address', stored.headers.location, `/v1/meshes/${sha256}`);
  await put(run, base, body, kGlb, 200);
  const seen = await run.json(base, 'getMesh', {sha256, status: 200});
  run.expectEqual('faces of a stored mesh', seen.analysis?.faces, 50);
  const other = await run.json(base, 'putMesh', {sha256, headers: kGlb, body: meshes.glb(6), status: 400});
  run.expectEqual('other bytes under that name', other.code, 'digest_mismatch');
  await jobsOf(run, base, sha256);
}

async function jobsOf(run, base, sha256) {
  const text = (mesh) => Buffer.from(JSON.stringify({mesh, options: {method: 'asap'}}));
  await ofTheMesh(run, base, sha256);
  for (const id of kSubmissions) {
    const job = newId();
    await run.call(base, id, {job, headers: kJson, body: text(sha256), status: 200});
    const missing = await run.json(base, id,
                                   {job: newId(), headers: kJson, body: text(digest('none')), status: 404});
    run.expectEqual(`${id} of a mesh that is not there`, missing.pointer, '/mesh');
  }
  const source = Buffer.from('{"source": "https://example.com/x.glb"}');
  const nowhere = await run.json(base, 'createJob', {headers: kJson, body: source, status: 422});
  run.expectEqual('an address without --source-hosts', `${nowhere.code} ${nowhere.pointer}`, 'source_refused /source');
  const twice = await run.json(base, 'createJob', {
    headers: kJson, body: text(sha256), query: {method: 'arap'}, status: 422,
  });
  run.expectEqual('options in two places', twice.pointer, '/method');
}

/** The call whose path names the mesh: the same job, by the options alone. */
async function ofTheMesh(run, base, sha256) {
  const send = (body, status, headers = kJson) =>
    run.json(base, kOfMesh, {sha256, headers, body: Buffer.from(body), status});
  const job = await send('{"method": "asap"}', 200);
  run.expectEqual('its options', job.options?.method, 'asap');
  await send('{}', 202, {'Content-Type': 'application/json', 'Cache-Control': 'no-cache'});
  await send('{"method": ', 400);
  await send('v 0 0 0', 415, {'Content-Type': 'model/obj'});
  run.expectEqual('pointer to its option', (await send('{"method": 7}', 422)).pointer, '/method');
  const named = {...kJson, 'Idempotency-Key': `of a mesh ${sha256}`.replaceAll(' ', '-')};
  await send('{"method": "asap"}', 200, named);
  await send('{"method": "arap"}', 409, named);
  const none = digest('none');
  const missing = await run.json(base, kOfMesh, {sha256: none, headers: kJson, body: Buffer.from('{}'), status: 404});
  run.expectEqual('a mesh that is not there', missing.code, 'mesh_not_found');
  const head = `POST /v1/meshes/${sha256}/jobs HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n`;
  run.judge('options without length', kOfMesh, await raw(base, head), 411);
}

/** Whatever cannot be read is stored as well; to look at it says why no job can be made of it. */
export async function brokenMeshes(run, base) {
  for (const [body, code] of [['no mesh', 'unknown_format'], ['v 0 0 0\nf 1 2 3\n', 'malformed_obj']]) {
    const bytes = Buffer.from(body);
    await put(run, base, bytes, {'Content-Type': 'model/obj'}, 201);
    const seen = await run.json(base, 'getMesh', {sha256: digest(bytes), status: 200});
    run.expectEqual(`the problem of "${body}"`, seen.problem?.code, code);
  }
}

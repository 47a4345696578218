// Meshes that are stored and made jobs of, by name.
import * as meshes from '../meshes.mjs';
import {digest, kGlb, kSubmissions, newId} from './shared.mjs';

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
  for (const id of kSubmissions) {
    const job = newId();
    await run.call(base, id, {job, headers: kJson, body: text(sha256), status: 200});
    const missing = await run.json(base, id,
                                   {job: newId(), headers: kJson, body: text(digest('none')), status: 404});
    run.expectEqual(`${id} of a mesh that is not there`, missing.pointer, '/mesh');
  }
  const twice = await run.json(base, 'createJob', {
    headers: kJson, body: text(sha256), query: {method: 'arap'}, status: 422,
  });
  run.expectEqual('options in two places', twice.pointer, '/method');
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

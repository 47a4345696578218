// Jobs by name, lists of jobs and links to their files, at a server that asks for no keys.
import {request} from '../http.mjs';
import * as meshes from '../meshes.mjs';
import {kGlb, kWait, newId} from './shared.mjs';

export async function jobsByName(run, base) {
  const job = newId();
  const put = (headers, body, status) =>
      run.call(base, 'putJob', {job, headers, body, status});
  await put(kGlb, meshes.glb(6), 202);
  const again = JSON.parse((await put(kWait, meshes.glb(6), 200)).body.toString());
  run.expectEqual('the id of a job that was put', again.id, job);
  await put(kGlb, meshes.glb(7), 409);
  const named = {...kWait, 'Idempotency-Key': newId()};
  const first = await run.json(base, 'createJob', {headers: named, body: meshes.glb(3), status: 200});
  const same = await run.json(base, 'createJob', {headers: named, body: meshes.glb(3), status: 200});
  run.expectEqual('the job of a repeated request', same.id, first.id);
  const other = await run.json(base, 'createJob', {headers: named, body: meshes.glb(2), status: 409});
  run.expectEqual('another request of that name', other.code, 'idempotency_conflict');
  for (const [id, headers] of [['createAndWatchJob', named], ['putAndWatchJob', kGlb]])
    await run.call(base, id, {job, headers, body: meshes.glb(2), status: 409});
}

export async function lists(run, base) {
  for (let i = 0; i < 3; ++i) {
    await run.call(base, 'createJob', {headers: kWait, body: meshes.glb(3), status: 200});
  }
  const first = await run.json(base, 'listJobs', {query: {limit: 2, state: 'succeeded'}, status: 200});
  run.expectEqual('jobs on a page', first.jobs.length, 2);
  const rest = await run.json(base, 'listJobs', {query: {limit: 200, cursor: first.next}, status: 200});
  const ids = [...first.jobs, ...rest.jobs].map(({id}) => id);
  run.expectEqual('no job twice', new Set(ids).size, ids.length);
  const name = 'Stuhl „Müller“';
  await run.call(base, 'createJob', {query: {name}, headers: kWait, body: meshes.glb(3), status: 200});
  const named = await run.json(base, 'listJobs', {query: {name}, status: 200});
  run.expectEqual('jobs of a name', named.jobs.map((job) => job.name).join(), name);
  for (const query of [{name: 'a\nb'}, {name: 'a'.repeat(201)}, {limit: 0}, {limit: 201}, {state: 'lost'}, {cursor: 'x'}, {page: 1}]) {
    await run.call(base, 'listJobs', {query, status: 422});
  }
}

/** What a link can be to, and the operation that answers it. */
const kLinked = {result: 'getResult', report: 'getReport', 'layout.svg': 'getLayout',
                 'layout.png': 'getLayoutPng', 'preview.png': 'getPreview'};

export async function links(run, base) {
  const {id: job} = await run.json(base, 'createJob', {headers: kWait, body: meshes.glb(), status: 200});
  for (const [file, id] of Object.entries(kLinked)) {
    const {url} = await run.json(base, 'getLink', {job, query: {file, seconds: 60}, status: 200});
    const open = (link) => fetch(base + link);
    run.expectEqual(`a link to ${file}`, (await open(url)).status, 200);
    const changed = url.replace(/.$/, (digit) => (digit === '0' ? '1' : '0'));
    const refused = run.judge('a link with another signature', id, await request(base, {path: changed}), 403);
    run.expectEqual('its code', JSON.parse(refused.body.toString()).code, 'invalid_link');
  }
  await run.call(base, 'getLink', {job, query: {seconds: 0}, status: 422});
  await run.call(base, 'getLink', {job, query: {file: 'document'}, status: 422});
  await run.call(base, 'getLink', {job: newId(), status: 404});
}

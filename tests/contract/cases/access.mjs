// Jobs by name, lists of jobs and links to their files, at a server that asks for no keys.
import {raw, request} from '../http.mjs';
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
                 'layout.png': 'getLayoutPng', 'preview.png': 'getPreview', events: 'watchJob', job: 'getJob'};

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

/** Tickets where no keys are: they have no key, and are bounded as elsewhere. */
export async function tickets(run, base) {
  const {urls} = await run.json(base, 'createTickets', {query: {count: 2, seconds: 60, max_bytes: 1e6}, status: 200});
  run.expectEqual('tickets', urls.length, 2);
  const send = (url, body) => request(base, {method: 'POST', path: url, headers: kWait, body});
  const sent = run.judge('a job by a ticket', 'createJob', await send(urls[0], meshes.glb()), 200);
  const {links} = JSON.parse(sent.body.toString());
  run.expectEqual('its signed result', (await fetch(base + links.result)).status, 200);
  run.judge('another job by it', 'createJob', await send(urls[0], meshes.glb(7)), 409);
  for (const query of [{seconds: 86401}, {count: 0}, {max_bytes: 'x'}])
    await run.call(base, 'createTickets', {query, status: 422});
  const bare = 'POST /v1/tickets HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n';
  run.judge('tickets without length', 'createTickets', await raw(base, bare), 411);
}

// A job from its submission to its removal: its state, its events, its result and its failures.
import {request} from '../http.mjs';
import * as meshes from '../meshes.mjs';
import {kOutcomes} from '../run.mjs';
import {parseEvents} from '../spec.mjs';
import {pictures} from './pictures.mjs';
import {failure, kGlb, kRepresentations, kWait, newId, validGltf} from './shared.mjs';

const kAnew = {...kGlb, 'Cache-Control': 'no-cache'};  // not answered from the store

export async function lifeOfAJob(run, base) {
  const created = await run.call(base, 'createJob',
                                 {headers: kAnew, body: meshes.glb(), status: 202});
  const job = created.headers.location?.split('/').pop();
  const watched = await run.call(base, 'watchJob', {job, status: 200});
  const events = parseEvents(watched.body.toString());
  run.expectEqual('the last event', events.at(-1)?.event, 'succeeded');
  await resume(run, base, job, events);
  await run.call(base, 'getJob', {job, status: 200});
  await run.call(base, 'getResult', {job, status: 200});
  for (const type of kRepresentations) await representation(run, base, job, type);
  await run.call(base, 'getResult', {job, headers: {Accept: 'image/png'}, status: 406});
  await partsOfAResult(run, base, job);
  await run.call(base, 'getReport', {job, status: 200});
  await pictures(run, base, job);
  await run.call(base, 'deleteJob', {job, status: 204});
  for (const id of ['getJob', 'deleteJob', 'watchJob', ...kOutcomes]) {
    await run.call(base, id, {job, status: 404, name: 'a removed job is gone'});
  }
}

/** A reader that comes back gets exactly the events after the last one that it saw. */
async function resume(run, base, job, events) {
  const ids = events.map((event) => event.id);
  run.expect('ids count up', ids.every((id, i) => i === 0 || id > ids[i - 1]) ? [] : [ids.join()]);
  const middle = Math.floor(ids.length / 2);
  const rest = await run.call(base, 'watchJob',
                              {job, headers: {'Last-Event-ID': String(ids[middle])}, status: 200});
  const resumed = parseEvents(rest.body.toString()).map((event) => event.id).join();
  run.expectEqual('events after Last-Event-ID', resumed, ids.slice(middle + 1).join());
}

async function partsOfAResult(run, base, job) {
  const whole = await run.call(base, 'getResult', {job, status: 200});
  const {etag} = whole.headers;
  const get = (headers, status) => run.call(base, 'getResult', {job, headers, status});
  await get({'If-None-Match': etag}, 304);
  await get({'If-None-Match': '"another"'}, 200);
  const part = await get({Range: 'bytes=4-11', 'If-Range': etag}, 206);
  run.expectEqual('the part', part.body.toString('hex'),
                  whole.body.subarray(4, 12).toString('hex'));
  run.expectEqual('its place', part.headers['content-range'], `bytes 4-11/${whole.body.length}`);
  await get({Range: 'bytes=4-11', 'If-Range': '"another"'}, 200);
  const json = await run.call(base, 'getResultAsJson', {job, status: 200});
  const again = {'If-None-Match': json.headers.etag};
  await run.call(base, 'getResultAsJson', {job, headers: again, status: 304});
  await run.call(base, 'getResultAsJson', {job, headers: {Range: 'bytes=4-11'}, status: 206});
  await get({Range: `bytes=${whole.body.length}-`}, 200);
}

async function representation(run, base, job, type) {
  const answer = await run.call(base, 'getResult', {job, headers: {Accept: type}, status: 200});
  run.expectEqual(`media type for ${type}`, answer.headers['content-type']?.split(';')[0], type);
  if (type.startsWith('model/gltf')) await validGltf(run, type, answer.body);
}

/** Submitted and watched in one request: the job, then its events; sent again, the rest of them. */
export async function watchedSubmission(run, base) {
  const headers = {...kAnew, 'Idempotency-Key': `watched-${Date.now()}`};
  for (const [id, job] of [['createAndWatchJob', undefined], ['putAndWatchJob', newId()]]) {
    const whole = await run.call(base, id, {job, headers, body: meshes.glb(), status: 200});
    run.expectEqual(`type of ${id}`, whole.headers['content-type'], 'text/event-stream');
    const events = parseEvents(whole.body.toString());
    run.expectEqual('the first event', events[0].event, 'accepted');
    run.expectEqual('its job', events[0].data.links.self, whole.headers.location);
    run.expectEqual('the last event', events.at(-1).event, 'succeeded');
    const again = await run.call(base, id, {
      job, headers: {...headers, 'Last-Event-ID': '1'}, body: meshes.glb(), status: 200,
    });
    const ids = (list) => list.slice(1).map((event) => event.id).join();
    run.expectEqual('the rest', ids(parseEvents(again.body.toString())), ids(events.slice(1)));
  }
  await negotiated(run, base);
}

/** What Accept chooses is what calls of their own answer. */
async function negotiated(run, base) {
  const send = async (path, Accept, id, method = 'POST') => {
    const body = method === 'POST' ? meshes.glb() : undefined;
    const answer = await request(base, {method, path, headers: {...kGlb, Accept}, body});
    return run.judge(`${path} as ${Accept}`, id, answer, 200);
  };
  const events = await send('/v1/jobs', 'text/event-stream', 'createAndWatchJob');
  await send('/v1/unwrap', 'application/json', 'unwrapAsJson');
  const path = `${events.headers.location}/result`;
  const chosen = await send(path, 'application/json', 'getResultAsJson', 'GET');
  const own = await send(`${path}.json`, 'image/png', 'getResultAsJson', 'GET');
  run.expectEqual('the same JSON', chosen.body.toString(), own.body.toString());
}

export async function preferWait(run, base) {
  const answer = await run.call(base, 'createJob',
                                {headers: kWait, body: meshes.obj(), status: 200});
  const job = JSON.parse(answer.body.toString());
  run.expectEqual('a job that was waited for', job.state, 'succeeded');
  const result = await run.call(base, 'getResult', {job: job.id, status: 200});
  run.expectEqual('OBJ in, OBJ out', result.headers['content-type']?.split(';')[0], 'model/obj');
  run.expectEqual('the OBJ has texture coordinates', /^vt /m.test(result.body.toString()), true);
}

/** The four corners of a cell, held as seen from behind. */
const kTurnedOver = [[0, .8, .2], [1, .2, .2], [3, .8, .8], [4, .2, .8]]
  .map(([vertex, ...uv]) => ({vertex, uv}));

/** Options that a mesh without UVs cannot be done with. */
const kRefusedWith = {
  no_texture_coordinates: {repack_only: true},
  does_not_fit: {texels_per_unit: 1e5, resolution: 64},
  guarantee_failed: {constraints: JSON.stringify(kTurnedOver)},
};

export async function failedJobs(run, base) {
  for (const [code, body] of Object.entries(meshes.kRefused)) {
    await failure(run, base, {body, code, status: statusOf(code)});
  }
  for (const [code, body] of Object.entries(meshes.kRefusedTextures)) {
    const query = {textures: 'transfer'};
    await failure(run, base, {body, query, code, status: statusOf(code)});
  }
  for (const [code, query] of Object.entries(kRefusedWith)) {
    await failure(run, base, {body: meshes.obj(), query, code, status: 422});
  }
}

/** What the title of each group of codes says: see api/error_table.cpp. */
function statusOf(code) {
  if (code.startsWith('malformed_')) return 400;
  return code === 'unknown_format' ? 415 : 422;
}

/** A reader who comes after more events than are kept is told which ones are gone. */
export async function gap(run, base) {
  const query = {'stop.iterations': 5000};
  const job = await run.json(base, 'createJob',
                             {query, headers: kWait, body: meshes.glb(2), status: 200});
  const answer = await run.call(base, 'watchJob', {job: job.id, status: 200});
  const [first, second] = parseEvents(answer.body.toString());
  run.expectEqual('what comes first', first?.event, 'gap');
  run.expectEqual('what comes next', second?.id, first?.data.last + 1);
}

// Every operation with the statuses that a server at its defaults gives.
import {readFileSync} from 'node:fs';
import validator from 'gltf-validator';

import {multipart, raw, request} from './http.mjs';
import * as meshes from './meshes.mjs';
import {kOutcomes} from './run.mjs';
import {parseEvents} from './spec.mjs';

const kUnknownJob = `j_${'0'.repeat(32)}`;
const kGlb = {'Content-Type': 'model/gltf-binary'};
const kWait = {...kGlb, Prefer: 'wait=30'};
const kRepresentations = ['model/gltf-binary', 'model/gltf+json', 'model/obj', 'application/json'];

export async function service(run, base) {
  for (const id of ['getMethods', 'getLimits', 'getHealth', 'getReadiness']) {
    await run.call(base, id, {status: 200});
  }
  const contract = await run.call(base, 'getContract', {status: 200});
  run.expectEqual('the contract served is the contract tested', contract.body.toString(),
                  readFileSync(run.contract.path, 'utf8'));
}

export async function lifeOfAJob(run, base) {
  const created = await run.call(base, 'createJob',
                                 {headers: kGlb, body: meshes.glb(), status: 202});
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
  await get({Range: `bytes=${whole.body.length}-`}, 200);
}

/** Every picture in every colour, its tag and parts, and what its parameters may not be. */
async function pictures(run, base, job) {
  const colour = ['stretch', 'angle', 'area', 'flips'];
  const known = {getLayout: {colour}, getLayoutPng: {colour, size: [64, 200]},
                 getPreview: {size: [65, 256]}};
  for (const [id, parameters] of Object.entries(known)) {
    const get = (query, status, headers) => run.call(base, id, {job, query, headers, status});
    for (const [name, values] of Object.entries(parameters)) {
      for (const value of values) await get({[name]: value}, 200);
    }
    const {headers, body} = await get({}, 200);
    await get({}, 304, {'If-None-Match': headers.etag});
    const part = await get({}, 206, {Range: 'bytes=1-3'});
    run.expectEqual(`a part of ${id}`, part.body.toString('hex'), body.subarray(1, 4).toString('hex'));
    await badParameters(run, base, job, id);
  }
}

async function badParameters(run, base, job, id) {
  const bad = {colour: ['', 'red', 'Area'], size: ['63', '4097', '-64', '1e2', '64px', ''],
               color: ['area']};
  const pairs = Object.entries(bad).flatMap(([name, values]) => values.map((v) => [[name, v]]));
  for (const query of [...pairs, [['size', '64'], ['size', '65']]]) {
    const problem = await run.json(base, id, {job, query, status: 422});
    run.expectEqual(`code of ${id} ${query}`, problem.code, 'invalid_option');
    run.expectEqual(`pointer of ${id} ${query}`, problem.pointer, `/${query[0][0]}`);
  }
}

async function representation(run, base, job, type) {
  const answer = await run.call(base, 'getResult', {job, headers: {Accept: type}, status: 200});
  run.expectEqual(`media type for ${type}`, answer.headers['content-type']?.split(';')[0], type);
  if (type.startsWith('model/gltf')) await validGltf(run, type, answer.body);
}

async function validGltf(run, name, bytes) {
  const report = await validator.validateBytes(new Uint8Array(bytes));
  const errors = report.issues.messages.filter((issue) => issue.severity === 0);
  run.expect(`${name} is valid glTF`, errors.map((e) => `${e.code} ${e.pointer} ${e.message}`));
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

export async function everyOption(run, base) {
  const {properties} = run.contract.document.components.schemas.Options;
  for (const [name, schema] of Object.entries(properties)) {
    for (const value of schema.enum ?? []) {
      const query = {[name]: value, ...(name === 'padding' ? {resolution: 16384} : {})};
      const job = await run.json(base, 'createJob',
                                 {query, headers: kWait, body: meshes.glb(2), status: 200});
      run.expectEqual(`${name}=${value} ends`, job.state, 'succeeded');
      run.expectEqual(`${name}=${value} is resolved`, job.options?.[name], value);
    }
  }
}

/** How iterations stop is shown whole, whatever part of it was given. */
export async function stops(run, base) {
  const plain = {iterations: 7, tolerance: 1e-6, max_iterations: 500};
  const accelerated = {iterations: null, tolerance: 1e-3, max_iterations: 40};
  const cases = [[{'stop.iterations': 7}, plain],
                 [{'stop.tolerance': 1e-3, 'stop.max_iterations': 40}, accelerated]];
  for (const [query, stop] of cases) {
    const job = await run.json(base, 'createJob',
                               {query, headers: kWait, body: meshes.glb(), status: 200});
    run.expectEqual('the whole stop', JSON.stringify(job.options?.stop), JSON.stringify(stop));
    const {charts} = await run.json(base, 'getReport', {job: job.id, status: 200});
    const wanted = stop.iterations ? charts[0].iterations === 7 : charts[0].iterations <= 40;
    run.expectEqual(`iterations for ${JSON.stringify(query)}`, wanted, true);
  }
}

/** A job with several lambdas answers with the map of each, in every representation. */
export async function curve(run, base) {
  const query = {method: 'hybrid', lambda: '1,0.01'};
  const {id: job} = await run.json(base, 'createJob',
                                   {query, headers: kWait, body: meshes.glb(), status: 200});
  for (const id of kOutcomes) {
    const bodies = [];
    for (const lambda of ['1', '0.01']) {
      const {body} = await run.call(base, id, {job, query: {lambda}, status: 200});
      bodies.push(body.toString('hex'));
    }
    const first = await run.call(base, id, {job, status: 200});
    run.expectEqual(`${id}: the first is the usual`, first.body.toString('hex'), bodies[0]);
    run.expectEqual(`${id}: the second is another`, bodies[1] === bodies[0], false);
    const problem = await run.json(base, id, {job, query: {lambda: '2'}, status: 422});
    run.expectEqual(`${id}: pointer of another lambda`, problem.pointer, '/lambda');
  }
  const report = await run.json(base, 'getReport', {job, query: {lambda: '0.01'}, status: 200});
  run.expectEqual('the curve', report.curve.map(({lambda}) => lambda).join(), '1,0.01');
  const watched = await run.call(base, 'watchJob', {job, status: 200});
  const lambdas = parseEvents(watched.body.toString()).map(({data}) => data.lambda);
  run.expectEqual('events of both', [1, 0.01].every((lambda) => lambdas.includes(lambda)), true);
}

/** Positions that hold, and positions that contradict each other. */
export async function constraints(run, base) {
  const pins = [{vertex: 0, uv: [0.1, 0.1]}, {vertex: 2, uv: [0.8, 0.1]}];
  const send = (list, name) => run.json(base, 'createJob', {
    query: {constraints: JSON.stringify(list)}, headers: kWait, body: meshes.glb(2), status: 200,
    name});
  const job = await send(pins, 'positions');
  run.expectEqual('a job with positions', job.state, 'succeeded');
  run.expectEqual('positions, resolved', JSON.stringify(job.options?.constraints),
                  JSON.stringify(pins.map((pin) => ({...pin, weight: null, mesh: 0}))));
  const headers = {Accept: 'application/json'};
  const result = await run.json(base, 'getResult', {job: job.id, headers, status: 200});
  const [mesh] = result.meshes;
  for (const {vertex, uv} of pins) {
    const at = mesh.vertex_map.indexOf(vertex);
    const off = Math.max(...[0, 1].map((c) => Math.abs(mesh.uv[2 * at + c] - uv[c])));
    run.expectEqual(`vertex ${vertex} is in its place`, off < 1e-6, true);
  }
  const failed = await send([...pins, {vertex: 0, uv: [0.5, 0.5]}], 'a contradiction');
  run.expectEqual('a contradiction', failed.problem?.code, 'invalid_constraint');
  await run.call(base, 'getResult', {job: failed.id, status: 422});
}

export async function badOptions(run, base) {
  const bad = {method: 'lscm', lambda: '-1', lambda_units: 'miles', 'stop.iterations': '0',
               'stop.tolerance': '1', 'stop.max_iterations': '1000000000', initial: '7',
               pins: 'none', guarantee: 'some', repair: 'none', boundary: 'oval',
               constraints: '7', seams: 'yes', resolution: '15', padding: '-1', output: 'png'};
  for (const [name, value] of Object.entries({...bad, lamda: '1', iterations: '10', stop: '10'})) {
    await badOption(run, base, [[name, value]], name.replace('.', '/'));
  }
  await badOption(run, base, [['lambda', '1,2,1']], 'lambda');
  await badOption(run, base, [['constraints', '[{"vertex":0,"uv":[0]}]']], 'constraints/0/uv');
  await badOption(run, base, [['constraints', '[{"vertex":0,"uv":[0,0]}]'], ['method', 'abf']],
                  'constraints');
  await badOption(run, base, [['lambda', 'nan']], 'lambda');
  await badOption(run, base, [['method', 'arap'], ['method', 'asap']], 'method');
  await badOption(run, base, [['resolution', '16'], ['padding', '5']], 'padding');
}

async function badOption(run, base, query, name) {
  for (const id of ['createJob', 'unwrap']) {
    const problem = await run.json(base, id,
                                   {query, headers: kGlb, body: meshes.glb(), status: 422});
    run.expectEqual(`code for a bad ${name}`, problem.code, 'invalid_option');
    run.expectEqual(`pointer for a bad ${name}`, problem.pointer, `/${name}`);
  }
}

export async function failedJobs(run, base) {
  for (const [code, body] of Object.entries(meshes.kRefused)) {
    await failure(run, base, {body, code, status: statusOf(code)});
  }
}

/** What the title of each group of codes says: see api/error_table.cpp. */
function statusOf(code) {
  if (code.startsWith('malformed_')) return 400;
  return code === 'unknown_format' ? 415 : 422;
}

/** Both ways to send an asset that cannot be done, and what its job answers afterwards. */
export async function failure(run, base, {body, code, status}) {
  const type = {'Content-Type': 'application/octet-stream'};
  const direct = await run.json(base, 'unwrap', {headers: type, body, status});
  run.expectEqual(`unwrap's code at ${status}`, direct.code, code);
  const created = await run.json(base, 'createJob',
                                 {headers: {...type, Prefer: 'wait=30'}, body, status: 200});
  run.expectEqual(`a job of ${code}`, created.state, 'failed');
  run.expectEqual(`its problem`, created.problem?.code, code);
  for (const id of kOutcomes) {
    const problem = await run.json(base, id, {job: created.id, status});
    run.expectEqual(`${id} of a failed job`, problem.code, code);
  }
  const watched = await run.call(base, 'watchJob', {job: created.id, status: 200});
  run.expectEqual('its last event', parseEvents(watched.body.toString()).at(-1)?.event, 'failed');
}

export async function unwrapAtOnce(run, base) {
  for (const type of kRepresentations) {
    const answer = await run.call(base, 'unwrap', {
      headers: {...kGlb, Accept: type}, body: meshes.glb(), status: 200,
    });
    run.expectEqual(`unwrap as ${type}`, answer.headers['content-type']?.split(';')[0], type);
    if (type.startsWith('model/gltf')) await validGltf(run, type, answer.body);
  }
  await run.call(base, 'unwrap', {headers: {...kGlb, Accept: 'text/html'}, body: meshes.glb(),
                                  status: 406});
  const conditions = {'If-None-Match': '*', Range: 'bytes=0-3'};  // of GET alone
  await run.call(base, 'unwrap',
                 {headers: {...kGlb, ...conditions}, body: meshes.glb(), status: 200});
}

export async function multipartBodies(run, base) {
  const {text, buffer} = meshes.gltf('some/grid.bin');
  const parts = [
    {name: 'options', type: 'application/json', body: '{"method":"hybrid","lambda":0.5}'},
    {name: 'mesh', filename: 'grid.gltf', type: 'model/gltf+json', body: text},
    {name: 'buffer', filename: 'some/grid.bin', type: 'application/octet-stream', body: buffer},
  ];
  const good = multipart(parts);
  const job = await run.json(base, 'createJob', {
    headers: {...good.headers, Prefer: 'wait=30'}, body: good.body, status: 200,
  });
  run.expectEqual('a multipart job', job.state, 'succeeded');
  run.expectEqual('its options', job.options?.lambda, 0.5);
  await run.call(base, 'unwrap', {...multipart(parts), status: 200});
  await missingBuffer(run, base, parts.slice(0, 2));
  await badMultipart(run, base, parts);
}

async function missingBuffer(run, base, parts) {
  const problem = await run.json(base, 'unwrap', {...multipart(parts), status: 422});
  run.expectEqual('a buffer that was not sent', problem.code, 'missing_buffer');
}

async function badMultipart(run, base, [options, mesh, buffer]) {
  const bad = {
    'no mesh': [options, buffer],
    'two meshes': [mesh, mesh],
    'options twice': [options, options, mesh, buffer],
    'a buffer without a name': [mesh, {...buffer, filename: undefined}],
    'options that are no JSON': [{...options, body: '{"method":'}, mesh, buffer],
  };
  for (const [name, parts] of Object.entries(bad)) {
    for (const id of ['createJob', 'unwrap']) {
      await run.call(base, id, {...multipart(parts), status: 400, name});
    }
  }
  const wrong = multipart([{...options, body: '{"stop":{"iterations":"10"}}'}, mesh, buffer]);
  const problem = await run.json(base, 'createJob', {...wrong, status: 422});
  run.expectEqual('pointer into the options part', problem.pointer, '/stop/iterations');
  const pinsTwice = '{"pins":"diameter","pins":"spectral"}';
  const twice = multipart([{...options, body: pinsTwice}, mesh, buffer]);
  run.expectEqual('pointer to a member given twice',
                  (await run.json(base, 'createJob', {...twice, status: 422})).pointer, '/pins');
  const truncated = multipart([mesh]);
  await run.call(base, 'createJob', {headers: truncated.headers, status: 400,
                                     body: truncated.body.subarray(0, 80), name: 'cut multipart'});
}

export async function badBodies(run, base) {
  for (const id of ['createJob', 'unwrap']) {
    const {path} = run.contract.operation(id);
    const headers = {'Content-Type': 'text/plain'};
    await run.call(base, id, {headers, body: meshes.glb(), status: 415});
    const answer = await raw(base, `POST ${path} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n`);
    run.judge('a body without length', id, answer, 411);
  }
  const {method, path} = run.contract.operation('unwrap');
  const headers = {...kGlb, 'Transfer-Encoding': 'chunked'};
  run.judge('a body in chunks', 'unwrap',
            await request(base, {method, path, headers, body: meshes.glb()}), 200);
}

/** Requests that begin and do not go on. */
export async function slowRequests(run, base) {
  const head = 'POST /v1/jobs HTTP/1.1\r\nHost: x\r\n';
  const starts = {'half a head': head, 'half a body': `${head}Content-Length: 100\r\n\r\nhalf`};
  await Promise.all(Object.entries(starts).map(async ([name, text]) =>
    run.judge(name, 'createJob', await raw(base, text), 408)));
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

/** HEAD is GET without the body. */
export async function heads(run, base) {
  for (const {id, method, path} of run.contract.operations()) {
    if (method !== 'GET' || path.includes('{id}')) continue;
    const get = await run.call(base, id, {status: 200});
    const answer = await request(base, {method: 'HEAD', path});
    run.expectEqual(`HEAD ${path}`, answer.status, get.status);
    run.expectEqual(`its body`, answer.body.length, 0);
    run.expectEqual(`its type`, answer.headers['content-type'], get.headers['content-type']);
  }
}

export async function unknownJobs(run, base) {
  for (const id of ['getJob', 'deleteJob', 'watchJob', ...kOutcomes]) {
    for (const job of [kUnknownJob, 'j_1', 'x', '%2e%2e', 'j_%00']) {
      await run.call(base, id, {job, status: 404, name: `unknown job ${job}`});
    }
  }
}

/** What 4XX stands for at every call: paths and methods that are not there, broken requests. */
export async function anyCall(run, base) {
  for (const path of ['/', '/v1', '/v1/jobs/', '/v1/nothing', '/openapi.yaml/x']) {
    run.judge(`no path ${path}`, 'getMethods', await request(base, {path}), 404);
  }
  for (const {id, path} of run.contract.operations()) {
    const answer = await request(base, {method: 'PATCH', path: path.replace('{id}', kUnknownJob)});
    run.judge(`PATCH ${path}`, id, answer, 405);
    run.expect(`Allow of ${path}`, answer.headers.allow ? [] : ['the header is missing']);
  }
  const long = `GET /v1/limits HTTP/1.1\r\nHost: x\r\nX-Long: ${'x'.repeat(100_000)}\r\n\r\n`;
  run.judge('long headers', 'getLimits', await raw(base, long), 431);
  const both = 'POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\n' +
      'Transfer-Encoding: chunked\r\n\r\n';
  run.judge('two lengths', 'createJob', await raw(base, both), 400);
}

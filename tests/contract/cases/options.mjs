// Every option with every value of its enumeration, what it is resolved to, and what is refused.
import * as meshes from '../meshes.mjs';
import {kOutcomes} from '../run.mjs';
import {parseEvents} from '../spec.mjs';
import {kGlb, kWait} from './shared.mjs';

export async function everyOption(run, base) {
  for (const [name, schema] of Object.entries(run.contract.options())) {
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
  const result = await run.json(base, 'getResultAsJson', {job: job.id, status: 200});
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

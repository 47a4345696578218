// The statuses that need a server in a special state: tiny limits, a full queue, results that
// expire, a server that drains. Each state is a server of its own.
import {failure, kOfMesh, kSubmissions, newId, ofNoMesh} from './cases/shared.mjs';
import {openStream} from './http.mjs';
import * as meshes from './meshes.mjs';
import {kOutcomes} from './run.mjs';
import {withServer} from './server.mjs';

const kGlb = {'Content-Type': 'model/gltf-binary'};
const kSlow = {'stop.iterations': 10_000};  // minutes of work, unless it is cancelled
const kSlowMesh = meshes.glb(150);
const kPatience = 30_000;            // ms

/** Asks again until done(answer) holds; gives up after kPatience. */
async function eventually(ask, done) {
  const end = Date.now() + kPatience;
  for (;;) {
    const answer = await ask();
    if (done(answer) || Date.now() > end) return answer;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

function slowJob(run, base, status) {
  return run.call(base, 'createJob', {query: kSlow, headers: kGlb, body: kSlowMesh, status});
}

const idOf = (answer) => JSON.parse(answer.body.toString()).id;

/** Waits until a job runs. */
async function running(run, base, job) {
  await eventually(() => run.json(base, 'getJob', {job, status: 200}),
                   ({state}) => state !== 'queued');
}

export function tinyLimits(run, binary) {
  const flags = ['--workers', '1', '--max-body-bytes', '4000', '--max-faces', '20'];
  return withServer(binary, flags, async ({base}) => {
    await failure(run, base, {body: meshes.glb(4), code: 'too_many_faces', status: 413});
    for (const id of [...kSubmissions, 'putMesh']) {
      const job = newId();
      const problem = await run.json(base, id,
                                     {job, headers: kGlb, body: meshes.glb(20), status: 413});
      run.expectEqual(`${id} of a long body`, problem.code, 'body_too_large');
      const headers = {...kGlb, 'Transfer-Encoding': 'chunked'};
      await run.call(base, id,
                     {job, headers, body: meshes.glb(20), status: 413, name: 'long, in chunks'});
    }
    await run.call(base, kOfMesh, {...ofNoMesh({materials: ['x'.repeat(5000)]}), status: 413});
  });
}

export function fewVertices(run, binary) {
  return withServer(binary, ['--workers', '1', '--max-vertices', '30'], async ({base}) => {
    await failure(run, base, {body: meshes.glb(8), code: 'too_many_vertices', status: 413});
  });
}

export function littleMemory(run, binary) {
  return withServer(binary, ['--workers', '1', '--memory-limit', '1000'], async ({base}) => {
    await failure(run, base, {body: meshes.glb(2), code: 'too_much_memory', status: 413});
  });
}

export function smallSyncLimit(run, binary) {
  return withServer(binary, ['--workers', '1', '--max-sync-faces', '20'], async ({base}) => {
    const problem = await run.json(base, 'unwrap',
                                   {headers: kGlb, body: meshes.glb(4), status: 413});
    run.expectEqual('unwrap of a mesh for /v1/jobs', problem.code, 'too_many_faces');
    const headers = {...kGlb, Prefer: 'wait=30'};
    const job = await run.json(base, 'createJob', {headers, body: meshes.glb(4), status: 200});
    run.expectEqual('the same mesh as a job', job.state, 'succeeded');
  });
}

export function fullQueue(run, binary) {
  return withServer(binary, ['--workers', '1', '--max-queue', '1'], async ({base}) => {
    const first = idOf(await slowJob(run, base, 202));
    await running(run, base, first);
    const second = idOf(await slowJob(run, base, 202));
    await slowJob(run, base, 429);
    for (const id of kSubmissions) {
      await run.call(base, id, {job: newId(), headers: kGlb, body: meshes.glb(), status: 429});
    }
    await run.call(base, kOfMesh, {...ofNoMesh(), status: 429});
    await unfinished(run, base, first);
    await unfinished(run, base, second);
    await cancelled(run, base, second);
    await cancelled(run, base, first);
  });
}

async function unfinished(run, base, job) {
  for (const id of kOutcomes) {
    const problem = await run.json(base, id, {job, status: 409});
    run.expectEqual(`${id} of a live job`, problem.code, 'job_unfinished');
  }
}

async function cancelled(run, base, job) {
  await run.call(base, 'deleteJob', {job, status: 202});
  const last = await eventually(() => run.json(base, 'getJob', {job, status: 200}),
                                ({state}) => state === 'cancelled');
  run.expectEqual('a cancelled job', last.state, 'cancelled');
  const problem = await run.json(base, 'getResult', {job, status: 409});
  run.expectEqual('the result of a cancelled job', problem.code, 'cancelled');
  await run.call(base, 'deleteJob', {job, status: 204});
}

export function tooManyStreams(run, binary) {
  return withServer(binary, ['--workers', '1', '--max-streams', '1'], async ({base}) => {
    const job = idOf(await slowJob(run, base, 202));
    const stream = await openStream(base, `/v1/jobs/${job}/events`);
    run.expectEqual('the stream that fits', stream.status, 200);
    const problem = await run.json(base, 'watchJob', {job, status: 503});
    run.expectEqual('the stream too many', problem.code, 'too_many_streams');
    for (const id of ['createAndWatchJob', 'putAndWatchJob']) {
      const refused = await run.json(base, id,
                                     {job: newId(), headers: kGlb, body: meshes.glb(), status: 503});
      run.expectEqual(`${id} without a place to watch`, refused.code, 'too_many_streams');
    }
    stream.close();
    await run.call(base, 'deleteJob', {job, status: 202});
  });
}

export function expiredResults(run, binary) {
  return withServer(binary, ['--workers', '1', '--keep-seconds', '1'], async ({base}) => {
    const headers = {...kGlb, Prefer: 'wait=30'};
    const job = idOf(await run.call(base, 'createJob', {headers, body: meshes.glb(), status: 200}));
    for (const id of kOutcomes) {
      const answer = await eventually(() => run.call(base, id, {job}),
                                      ({status}) => status === 410);
      run.expectEqual(`${id} after its time`, answer.status, 410);
    }
  });
}

export function timeLimit(run, binary) {
  const flags = ['--workers', '1', '--max-job-seconds', '1', '--drain-seconds', '0'];
  return withServer(binary, flags, async ({base}) => {
    const job = await run.json(base, 'createJob', {
      query: kSlow, headers: {...kGlb, Prefer: 'wait=30'}, body: kSlowMesh, status: 200,
    });
    run.expectEqual('a job that takes too long', job.problem?.code, 'time_limit');
    const ended = await run.json(base, 'unwrap', {
      query: kSlow, headers: kGlb, body: kSlowMesh, status: 422,
    });
    run.expectEqual('a mesh that takes too long', ended.code, 'time_limit');
    await Promise.all(Array.from({length: 8}, () => slowJob(run, base, 202)));
    await Promise.all(['unwrap', 'unwrapAsJson'].map(
      (id) => run.call(base, id, {headers: kGlb, body: meshes.glb(), status: 409})));
  });
}

/** A daemon is sent SIGHUP for its configuration; only at a terminal does it mean the end. */
export function hangup(run, binary) {
  return withServer(binary, ['--workers', '1'], async ({base, pid}) => {
    process.kill(pid, 'SIGHUP');
    for (let i = 0; i < 3; ++i)
      await run.call(base, 'unwrap', {headers: kGlb, body: meshes.glb(), status: 200});
    await run.call(base, 'getReadiness', {status: 200});
  });
}

export function draining(run, binary) {
  return withServer(binary, ['--workers', '1'], async ({base, terminate}) => {
    const job = idOf(await slowJob(run, base, 202));
    await running(run, base, job);
    terminate();
    const ready = await eventually(() => run.call(base, 'getReadiness'),
                                   ({status}) => status === 503);
    run.expectEqual('readiness while draining', ready.status, 503);
    await slowJob(run, base, 503);
    for (const id of kSubmissions) {
      await run.call(base, id, {job: newId(), headers: kGlb, body: meshes.glb(), status: 503});
    }
    await run.call(base, kOfMesh, {...ofNoMesh(), status: 503});
    await run.call(base, 'getHealth', {status: 200});
    await run.call(base, 'deleteJob', {job, status: 202});
  });
}

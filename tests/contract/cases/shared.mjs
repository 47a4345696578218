// What several groups of cases send and judge.
import {createHash, randomBytes} from 'node:crypto';
import validator from 'gltf-validator';

import {kOutcomes} from '../run.mjs';
import {parseEvents} from '../spec.mjs';

export const kGlb = {'Content-Type': 'model/gltf-binary'};
export const kWait = {...kGlb, Prefer: 'wait=30'};
export const kRepresentations = ['model/gltf-binary', 'model/gltf+json', 'model/obj'];

/** Of a job that is not there. */
export const newId = () => `j_${randomBytes(16).toString('hex')}`;

/** SHA-256, as meshes are named by it. */
export const digest = (bytes) => createHash('sha256').update(bytes).digest('hex');

/** The calls that make jobs of a body. */
export const kSubmissions =
    ['createJob', 'putJob', 'createAndWatchJob', 'putAndWatchJob', 'unwrap', 'unwrapAsJson'];

/** The call that makes one of a mesh that is stored, whose body is the options. */
export const kOfMesh = 'createJobOfMesh';

/** A request by it, of a mesh that is not there. */
export const ofNoMesh = (options = {}) =>
  ({headers: {'Content-Type': 'application/json'}, body: Buffer.from(JSON.stringify(options))});

export async function validGltf(run, name, bytes) {
  const report = await validator.validateBytes(new Uint8Array(bytes));
  const errors = report.issues.messages.filter((issue) => issue.severity === 0);
  run.expect(`${name} is valid glTF`, errors.map((e) => `${e.code} ${e.pointer} ${e.message}`));
}

/** Both ways to send an asset that cannot be done, and what its job answers afterwards. */
export async function failure(run, base, {body, query, code, status}) {
  const type = {'Content-Type': 'application/octet-stream'};
  const direct = await run.json(base, 'unwrap', {query, headers: type, body, status});
  run.expectEqual(`unwrap's code at ${status}`, direct.code, code);
  const created = await run.json(base, 'createJob',
                                 {query, headers: {...type, Prefer: 'wait=30'}, body, status: 200});
  run.expectEqual(`a job of ${code}`, created.state, 'failed');
  run.expectEqual(`its problem`, created.problem?.code, code);
  for (const id of kOutcomes) {
    const problem = await run.json(base, id, {job: created.id, status});
    run.expectEqual(`${id} of a failed job`, problem.code, code);
  }
  const watched = await run.call(base, 'watchJob', {job: created.id, status: 200});
  run.expectEqual('its last event', parseEvents(watched.body.toString()).at(-1)?.event, 'failed');
}

// Ways to send an asset: at once, and as the parts of a form.
import {multipart} from '../http.mjs';
import * as meshes from '../meshes.mjs';
import {kGlb, kRepresentations, validGltf} from './shared.mjs';

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

// The pictures of a result and their parameters.

/** Every picture in every colour, its tag and parts, and what its parameters may not be. */
export async function pictures(run, base, job) {
  const colour = ['stretch', 'angle', 'area', 'flips'];
  const look = {legend: [0, 1], background: ['page', 'none'], wireframe: [0, 1], numbers: [0, 1], page: [1]};
  const view = ['auto', 'front', 'back', 'left', 'right', 'top', 'bottom', 'turntable', '30,-20.5', '-360,90'];
  const known = {getLayout: {colour, ...look}, getLayoutPng: {colour, ...look, size: [64, 200, 'page']},
                 getPreview: {size: [65, 256], view}};
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
               color: ['area'], legend: ['2', 'yes'], background: ['red'], wireframe: ['-1'], numbers: ['all'],
               page: ['0', '2', '101', '1.5'],
               view: ['', 'side', '30', '30,91', '361,0', '1e2,0', '30,20,', 'nan,0', ' 30,20', '30;20']};
  const pairs = Object.entries(bad).flatMap(([name, values]) => values.map((v) => [[name, v]]));
  for (const query of [...pairs, [['size', '64'], ['size', '65']]]) {
    const problem = await run.json(base, id, {job, query, status: 422});
    run.expectEqual(`code of ${id} ${query}`, problem.code, 'invalid_option');
    run.expectEqual(`pointer of ${id} ${query}`, problem.pointer, `/${query[0][0]}`);
  }
}

// The calls about the server itself, and what every path and method answers.
import {readFileSync} from 'node:fs';
import {isDeepStrictEqual} from 'node:util';
import {brotliDecompressSync, gunzipSync} from 'node:zlib';

import {raw, request} from '../http.mjs';
import * as meshes from '../meshes.mjs';
import {kOutcomes, pathTo} from '../run.mjs';
import {kGlb, kSubmissions, newId} from './shared.mjs';

const kUnknownJob = `j_${'0'.repeat(32)}`;

export async function service(run, base) {
  for (const id of ['getMethods', 'getLimits', 'getHealth', 'getReadiness']) {
    await run.call(base, id, {status: 200});
  }
  const contract = await run.call(base, 'getContract', {status: 200});
  run.expectEqual('the contract served is the contract tested', contract.body.toString(),
                  readFileSync(run.contract.path, 'utf8'));
  const asJson = await run.json(base, 'getContractAsJson', {status: 200});
  run.expect('the same as JSON', isDeepStrictEqual(asJson, run.contract.withExamples()) ? [] : ['it differs']);
  const texts = ['getContract', 'getContractAsJson', 'getDocs', 'getPage'];
  for (const id of texts) {
    const {headers} = await run.call(base, id, {status: 200});
    const same = {'If-None-Match': headers.etag};
    await run.call(base, id, {headers: same, status: 304, name: `${id} that is known`});
  }
  for (const id of ['getPage', 'getDocs']) await filesOfPage(run, base, id);
  const away = await request(base, {path: '/assets/index-of-another-version.js'});
  run.judge('a file of another version', 'getPageFile', away, 404);
}

/** What a page loads: the same bytes in every coding, to be kept for good. */
async function filesOfPage(run, base, id) {
  const page = await run.call(base, id, {status: 200});
  run.expectEqual('its policy', page.headers['content-security-policy']?.split(';')[0], "default-src 'none'");
  const paths = [...page.body.toString().matchAll(/(?:src|href)="\.\/(assets\/[^"]+)"/g)].map(([, path]) => path);
  run.expect('a script and a style', ['.js', '.css'].filter((end) => !paths.some((path) => path.endsWith(end))));
  for (const path of paths) {
    const get = async (coding) => {
      const answer = await request(base, {path: `/${path}`, headers: coding ? {'Accept-Encoding': coding} : {}});
      run.judge(`${path} as ${coding ?? 'it is'}`, 'getPageFile', answer, 200);
      run.expectEqual('its coding', answer.headers['content-encoding'], coding);
      return answer;
    };
    const plain = await get(undefined);
    run.expectEqual('by gzip', gunzipSync((await get('gzip')).body).equals(plain.body), true);
    run.expectEqual('by Brotli', brotliDecompressSync((await get('br')).body).equals(plain.body), true);
    run.expectEqual('is kept', plain.headers['cache-control'], 'public, max-age=31536000, immutable');
  }
}

/** HEAD is GET without the body. */
export async function heads(run, base) {
  for (const {id, method, path} of run.contract.operations()) {
    if (method !== 'GET' || path.includes('{')) continue;
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

/** What `default` stands for at every call: paths and methods that are not there, broken requests. */
export async function anyCall(run, base) {
  for (const path of ['/v1', '/v1/jobs/', '/v1/nothing', '/openapi.yaml/x']) {
    run.judge(`no path ${path}`, 'getMethods', await request(base, {path}), 404);
  }
  for (const {id, path} of run.contract.operations()) {
    const answer = await request(base, {method: 'PATCH', path: pathTo(path, kUnknownJob)});
    run.judge(`PATCH ${path}`, id, answer, 405);
    run.expect(`Allow of ${path}`, answer.headers.allow ? [] : ['the header is missing']);
  }
  const long = `GET /v1/limits HTTP/1.1\r\nHost: localhost\r\nX-Long: ${'x'.repeat(100_000)}\r\n\r\n`;
  run.judge('long headers', 'getLimits', await raw(base, long), 431);
  const both = 'POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\n' +
      'Transfer-Encoding: chunked\r\n\r\n';
  run.judge('two lengths', 'createJob', await raw(base, both), 400);
}

/** What a page of another site can have a browser send to a server without keys. */
export async function otherSites(run, base) {
  const rebound = await request(base, {path: '/v1/jobs', headers: {Host: 'rebind.example:8080'}});
  run.judge('a name of somebody else', 'listJobs', rebound, 403);
  const {method, path} = run.contract.operation('createJob');
  const headers = {Origin: 'https://example.com'};
  run.judge('a form of another site', 'createJob',
            await request(base, {method, path, headers, body: meshes.glb()}), 403);
}

export async function badBodies(run, base) {
  for (const id of [...kSubmissions, 'putMesh']) {
    const operation = run.contract.operation(id);
    const headers = {'Content-Type': 'text/plain'};
    await run.call(base, id, {job: newId(), headers, body: meshes.glb(), status: 415});
    const line = `${operation.method} ${pathTo(operation.path, newId())} HTTP/1.1`;
    const answer = await raw(base, `${line}\r\nHost: localhost\r\nConnection: close\r\n\r\n`);
    run.judge('a body without length', id, answer, 411);
    if (id === 'putMesh') continue;
    const form = {'Content-Type': 'multipart/form-data; boundary=x'};
    await run.call(base, id, {job: newId(), headers: form, body: meshes.glb(), status: 400});
    await run.call(base, id, {job: newId(), headers: kGlb, body: meshes.glb(), status: 422,
                              query: {method: 'none'}});
  }
  const {method, path} = run.contract.operation('unwrap');
  const headers = {...kGlb, 'Transfer-Encoding': 'chunked'};
  run.judge('a body in chunks', 'unwrap',
            await request(base, {method, path, headers, body: meshes.glb()}), 200);
}

/** Requests that begin and do not go on. */
export async function slowRequests(run, base) {
  const head = 'POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\n';
  const starts = {'half a head': head, 'half a body': `${head}Content-Length: 100\r\n\r\nhalf`};
  await Promise.all(Object.entries(starts).map(async ([name, text]) =>
    run.judge(name, 'createJob', await raw(base, text), 408)));
}

// Clients that generators make of openapi.yaml: they are generated without a warning, compiled by
// tsc --strict, and each uploads a mesh, follows its job and downloads the asset.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {cpSync, mkdtempSync, rmSync, symlinkSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';

import {request} from '../http.mjs';
import * as meshes from '../meshes.mjs';
import {startServer} from '../server.mjs';

const here = fileURLToPath(new URL('.', import.meta.url));
const tools = join(here, '../../node_modules');
const folder = mkdtempSync(join(tmpdir(), 'unwrapd-generated-'));
const kNames = ['openapi-typescript', 'hey-api', 'orval-axios', 'orval-fetch'];
let server;

before(async () => {
  cpSync(here, folder, {recursive: true});
  symlinkSync(tools, join(folder, 'node_modules'));
  writeFileSync(join(folder, 'package.json'), '{"type": "commonjs"}');
  server = await startServer(process.env.UNWRAPD_BIN, ['--workers', '1']);
});

after(async () => {
  await server?.stop();
  rmSync(folder, {recursive: true});
});

/** Runs node; connections that the server closes meanwhile are seen. */
function run(...words) {
  return new Promise((resolve) => {
    execFile(process.execPath, words, {cwd: folder}, (error, stdout, stderr) =>
      resolve({said: stdout + stderr, status: error?.code ?? 0}));
  });
}

function generate(name) {
  const contract = new URL('../../../api/openapi.yaml', import.meta.url);
  const script = `import {kGenerators} from '${join(here, 'generate.mjs')}';
    await kGenerators['${name}'](new URL('${contract}'), '${join(folder, 'generated', name)}');`;
  return run('--input-type=module', '--eval', script);
}

const kCompile = ['--strict', '--target', 'es2022', '--module', 'commonjs', '--moduleResolution', 'node10',
                  '--esModuleInterop', '--skipLibCheck', '--types', 'node', '--lib', 'es2022,dom,dom.iterable',
                  '--outDir', 'built', '--rootDir', '.'];

/** The asset that a plain request gets, computed anew. */
async function plainly(body) {
  const headers = {'Content-Type': 'model/gltf-binary', 'Cache-Control': 'no-cache'};
  return (await request(server.base, {method: 'POST', path: '/v1/unwrap?preset=chart', headers, body})).body;
}

const driverOf = (name) => name.replace('-', '_');

const [major, minor] = process.versions.node.split('.').map(Number);
const skip = (major < 20 || (major === 20 && minor < 19)) && 'generators need Node 20.19';

/** All clients, generated and compiled: in one run of tsc, which reads the same libraries for each. */
let made;
function make() {
  made ??= (async () => {
    const generated = new Map();
    for (const name of kNames) generated.set(name, await generate(name));
    const compiled = await run(join(tools, 'typescript/bin/tsc'), ...kCompile, ...kNames.map((name) => `${driverOf(name)}.ts`));
    return {generated, compiled};
  })();
  return made;
}

for (const [index, name] of kNames.entries()) {
  test(`${name} makes a client that uploads, follows and downloads`, {skip}, async () => {
    const {generated, compiled} = await make();
    const {status, said} = generated.get(name);
    assert.equal(status, 0, said);
    assert.doesNotMatch(said, /warn|error|⚠/i);
    assert.equal(compiled.status, 0, compiled.said);
    const {unwrap} = createRequire(join(folder, 'built/'))(`./${driverOf(name)}.js`);
    const mesh = meshes.glb(6 + index);  // new to the server
    const {events, asset} = await unwrap(server.base, new Blob([mesh], {type: 'model/gltf-binary'}));
    assert.ok(events.includes('iteration'), events.join());
    assert.equal(events.at(-1), 'succeeded');
    assert.deepEqual(Buffer.from(await asset.arrayBuffer()), await plainly(mesh));
  });
}

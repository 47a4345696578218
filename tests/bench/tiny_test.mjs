// Every bench that needs no yardstick, on a tiny input: it ends well and tells figures. What they are
// says nothing here.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, test} from 'node:test';
import {fileURLToPath} from 'node:url';
import {promisify} from 'node:util';

import * as meshes from '../contract/meshes.mjs';
import {noChromium} from '../e2e/browsers.mjs';
import {isInstalled} from '../postgres/postgres.mjs';

const bin = process.env.UNWRAPD_BIN;
const here = dirname(fileURLToPath(import.meta.url));
const scratch = mkdtempSync(join(tmpdir(), 'unwrapd_bench_'));
after(() => rmSync(scratch, {recursive: true}));
const sheet = join(scratch, 'sheet.obj');
writeFileSync(sheet, meshes.obj(8));

/** What a program prints; rejects unless it ends with 0. */
async function printed(program, ...words) {
  const env = {...process.env, LOAD_SCALE: '0.01'};
  return (await promisify(execFile)(program, words, {env, timeout: 240_000})).stdout;
}

const script = (name, ...words) => printed(process.execPath, join(here, `${name}.mjs`), ...words);
const program = (name, ...words) => printed(join(bin, `unwrapd_${name}`), ...words);
const kept = (file) => JSON.parse(readFileSync(file, 'utf8'));

test('goals', async () => {
  const out = join(scratch, 'goals.json');
  await program('bench', out, '--tiny');
  assert.ok(kept(out).goals.length > 12);
});

test('methods', async () => {
  for (const method of ['asap', 'arap', 'hybrid', 'abf', 'linabf', 'cp', 'bff', 'ic', 'slim'])
    assert.match(await program('methods', 'one', method, '500'), /^\d+\.\d+ \d+ \d+\n$/);
});

test('converge', async () => {
  assert.match(await program('converge', sheet), /128 faces, 1 boundaries\n(.*\d+.*\n){4}/);
});

test('atlas', async () => {
  const table = await program('atlas', sheet, 'noisy:1000', 'made:torus:300:1');
  assert.match(table, /^sheet +128 +1 /m);
  assert.equal(table.match(/^\S+( +[\d.]+){14}$/gm)?.length, 3, table);
});

test('bijective', async () => {
  const table = await program('bijective', '--pairs=1', sheet, 'made:opened:900:1');
  assert.match(table, /^sheet +128 +0( +[\d.]+){9}$/m);
  assert.match(table, /^time: median [\d.]+ .*\n.*\nrise: median [\d.]+ %/m);
});

test('painted', async () => {
  const table = await program('painted', 'made:torus:300:1');
  assert.match(table, /^made:torus:300:1 +\d+( +[\d.]+){12}$/m);
  assert.match(table, /^median of after \/ before: in the half [\d.]+, in all [\d.]+$/m);
});

test('kept', async () => {
  const path = join(scratch, 'cube.obj');
  const points = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => `v ${i & 1} ${(i >> 1) & 1} ${i >> 2}`);
  writeFileSync(path, [...points, 'f 1 3 4 2', 'f 5 6 8 7', 'f 1 2 6 5', 'f 3 7 8 4', 'f 1 5 7 3', 'f 2 4 8 6', ''].join('\n'));
  const table = await script('kept', join(bin, 'unwrap'), '--effort', 'fast', path);
  assert.equal(table.match(/^cube +\d+ +\d+ +\d+ +\d+\.\d\d$/gm)?.length, 3, table);
});

test('store', async () => {
  assert.match(await program('store', '10'), /^sqlite +\d+ inserts\/s +\d+ taken and finished\/s +\d+ claimed in turn\/s$/m);
});

test('cost', async () => {
  const table = await script('cost', join(bin, 'unwrapd'), '1', sheet);
  assert.equal(table.match(/^sheet\.obj +\w+ +1 +\d+ +\d+\.\d\d$/gm)?.length, 3, table);
});

test('scene', {skip: !isInstalled()}, async () => {
  assert.match(await script('scene', join(bin, 'unwrapd'), '3', '1'), /^4( +[\d.]+){6}$/m);
});

test('farm', {skip: !isInstalled()}, async () => {
  const times = await script('farm', join(bin, 'unwrapd'), '3');
  for (const what of ['progress', 'cancel'])
    for (const where of ['one node', 'farm']) assert.match(times, new RegExp(`^${what}, ${where} +median +[\\d.]+`, 'm'));
});

test('cancel-latency', async () => {
  assert.match(await program('cancel_latency', 'disk:400'), /\d/);
});

test('engine', async () => {
  const out = join(scratch, 'engine.json');
  await program('engine', '20000', out);
  assert.ok(kept(out).rows.every(({factor_ms: ms}) => ms > 0));
});

test('load', async () => {
  const out = join(scratch, 'load.json');
  await script('load', join(bin, 'unwrapd'), out, '2');
  const {figures} = kept(out);
  assert.deepEqual(Object.keys(figures), ['streams', 'idle', 'queue', 'soak', 'shared_soak']);
  for (const {name, value} of Object.values(figures).flat()) assert.equal(typeof value, 'number', name);
});

test('isolation', async () => {
  const out = join(scratch, 'isolation.json');
  await script('isolation', join(bin, 'unwrapd'), out, '1', sheet);
  for (const {name, value} of kept(out).figures) assert.equal(typeof value, 'number', name);
});

test('frames', {skip: noChromium}, async () => {
  const out = join(scratch, 'frames.json');
  await script('frames', join(bin, 'unwrapd'), out, '200');
  assert.ok(kept(out).figures.every(({value}) => value >= 0));
});

test('defaults', async () => {
  const out = join(scratch, 'defaults.json');
  await script('defaults', bin, out, sheet);
  assert.deepEqual(kept(out).rows.map(({faces}) => faces), [128]);
});

test('request', async () => {
  assert.match(await script('request', bin, '200'), /ratio [\d.]+ \(asked: 1.1\)/);
});

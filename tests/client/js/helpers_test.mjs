// The transform of glTF-Transform, the helper of three.js, the examples, the types and the package in
// a browser, against the real server. UNWRAPD is the server.
import { Document, NodeIO } from "@gltf-transform/core";
import { BoxGeometry, BufferAttribute, TorusKnotGeometry } from "three";
import validator from "gltf-validator";
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { once } from "node:events";
import { readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { promisify } from "node:util";

import { glb } from "../../contract/meshes.mjs";
import { chromium, noChromium } from "../../e2e/browsers.mjs";
import { install } from "./installed.mjs";
import { restartable } from "./restartable.mjs";

const run = promisify(execFile);
let server;
let installed;
const at = (name) => join(installed.folder, name);

before(async () => {
  installed = install();
  server = await restartable("--cors-origins", "*");
});

after(async () => {
  await server?.end();
  installed?.remove();
});

/** A bumpy strip of triangles with a colour for each vertex, as a primitive. */
function primitiveOf(document, { strip = false, shift = 0 } = {}) {
  const buffer = document.getRoot().listBuffers()[0] ?? document.createBuffer();
  const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const corners = Array.from({ length: 10 }, (_, i) => [Math.floor(i / 2), i % 2, 0.1 * (i % 3) + shift]);
  const colours = Uint8Array.from({ length: 40 }, (_, i) => i);
  const primitive = document.createPrimitive()
    .setAttribute("POSITION", accessor("VEC3", Float32Array.from(corners.flat())))
    .setAttribute("COLOR_0", accessor("VEC4", colours).setNormalized(true));
  if (strip) return primitive.setMode(5);
  const triangles = Array.from({ length: 8 }, (_, i) => (i % 2 ? [i + 1, i, i + 2] : [i, i + 1, i + 2]));
  return primitive.setIndices(accessor("SCALAR", Uint16Array.from(triangles.flat())));
}

/** Corner by corner, the position and the colour of each triangle: what unwrapping must keep. */
function cornersOf(primitive) {
  const count = primitive.getIndices()?.getCount() ?? 0;
  return Array.from({ length: count }, (_, i) => primitive.getIndices().getScalar(i)).map((vertex) =>
    ["POSITION", "COLOR_0"].map((name) => primitive.getAttribute(name).getElement(vertex, [])));
}

/** Twice the area of each triangle on the page, positive where V up keeps the orientation. */
function areasOf(uv, index, count) {
  return Array.from({ length: count / 3 }, (_, t) => {
    const [a, b, c] = [0, 1, 2].map((k) => uv(index(3 * t + k)));
    return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  });
}

function assertAllUsed(document) {
  const isUsed = (accessor) => accessor.listParents().some(({ propertyType }) => propertyType === "Primitive");
  assert.ok(document.getRoot().listAccessors().every(isUsed), "no accessor is left over");
}

test("the transform writes UVs and keeps all else", async () => {
  const { unwrapd } = await installed.load("gltf-transform.js");
  const document = new Document();
  const [plain, strip] = [primitiveOf(document), primitiveOf(document, { strip: true, shift: 5 })];
  const lines = primitiveOf(document).setMode(1);
  const empty = primitiveOf(document);
  empty.getIndices().setArray(new Uint16Array(0));
  document.createMesh("all").addPrimitive(plain).addPrimitive(lines).addPrimitive(empty).addPrimitive(strip);
  const before = cornersOf(plain);
  await document.transform(unwrapd({ server: server.base }));
  assert.deepEqual(cornersOf(plain), before);
  assert.deepEqual(cornersOf(strip), cornersOf(primitiveOf(new Document(), { shift: 5 })));
  for (const other of [lines, empty]) assert.equal(other.getAttribute("TEXCOORD_0"), null);
  for (const accessor of [empty.getIndices(), ...empty.listAttributes()]) accessor.dispose();
  empty.dispose(); // which no valid file has
  assertAllUsed(document);
  for (const primitive of [plain, strip]) {
    assert.equal(primitive.getMode(), 4);
    const [uv, indices] = [primitive.getAttribute("TEXCOORD_0"), primitive.getIndices()];
    assert.equal(indices.getCount(), 24);
    const areas = areasOf((v) => [uv.getElement(v, [])[0], 1 - uv.getElement(v, [])[1]], (i) => indices.getScalar(i), 24);
    assert.ok(areas.every((area) => area > 0), `no triangle is turned over: ${areas}`);
  }
  const report = await validator.validateBytes(await new NodeIO().writeBinary(document));
  assert.equal(report.issues.numErrors, 0, JSON.stringify(report.issues.messages));
});

test("the transform leaves UVs that are there, unless it is to overwrite them", async () => {
  const { unwrapd } = await installed.load("gltf-transform.js");
  const document = new Document();
  const primitive = primitiveOf(document);
  const own = document.createAccessor().setType("VEC2").setArray(new Float32Array(20));
  document.createMesh().addPrimitive(primitive.setAttribute("TEXCOORD_0", own));
  await document.transform(unwrapd({ server: server.base }));
  assert.equal(primitive.getAttribute("TEXCOORD_0"), own);
  await document.transform(unwrapd({ server: server.base, texcoord: 1, groupBy: "scene" }));
  assert.deepEqual(primitive.getAttribute("TEXCOORD_0").getArray(), new Float32Array(20));
  assert.ok(primitive.getAttribute("TEXCOORD_1"));
  await document.transform(unwrapd({ server: server.base, overwrite: true }));
  assert.notDeepEqual(primitive.getAttribute("TEXCOORD_0").getArray(), new Float32Array(20));
  assertAllUsed(document);
});

test("what groupBy puts together shares a page", async () => {
  const { unwrapd } = await installed.load("gltf-transform.js");
  const coverage = async (groupBy) => {
    const document = new Document();
    for (const shift of [0, 5]) document.createMesh().addPrimitive(primitiveOf(document, { shift }));
    await document.transform(unwrapd({ server: server.base, groupBy }));
    const sums = document.getRoot().listMeshes().map((mesh) => {
      const [one] = mesh.listPrimitives();
      const [uv, indices] = [one.getAttribute("TEXCOORD_0"), one.getIndices()];
      return areasOf((v) => uv.getElement(v, []), (i) => indices.getScalar(i), 24).reduce((sum, area) => sum + Math.abs(area) / 2, 0);
    });
    return sums[0] + sums[1];
  };
  const [scene, mesh] = [await coverage("scene"), await coverage("mesh")];
  assert.ok(scene <= 1, `two meshes on one page cover ${scene}`);
  assert.ok(mesh > 1.2 * scene, `on a page each they cover ${mesh}, on one ${scene}`);
});

test("unwrapGeometry keeps attributes, morphs, groups and corners", async () => {
  const { unwrapGeometry } = await installed.load("three.js");
  const box = new BoxGeometry(1, 2, 3, 2, 2, 2);
  box.morphAttributes.position = [box.getAttribute("position").clone()];
  box.setAttribute("weight", new BufferAttribute(Uint8Array.from({ length: box.getAttribute("position").count }, (_, i) => i), 1));
  const { geometry, report } = await unwrapGeometry(box, {}, { server: server.base });
  assert.ok(report.charts.length >= 1);
  const corners = (of, name) => Array.from(of.index.array, (v) => [0, 1, 2].map((c) => of.getAttribute(name).getComponent(v, c)));
  for (const name of ["position", "normal"]) assert.deepEqual(corners(geometry, name), corners(box, name), name);
  assert.deepEqual(geometry.groups, box.groups);
  assert.equal(geometry.morphAttributes.position[0].count, geometry.getAttribute("position").count);
  assert.ok(geometry.getAttribute("weight").array instanceof Uint8Array);
  const uv = geometry.getAttribute("uv");
  const areas = areasOf((v) => [uv.getX(v), uv.getY(v)], (i) => geometry.index.getX(i), geometry.index.count);
  assert.ok(areas.every((area) => area > 0), "no triangle is turned over");
  const soup = await unwrapGeometry(new TorusKnotGeometry(1, 0.3, 24, 4).toNonIndexed(), {effort: "fast"}, { server: server.base });
  assert.equal(soup.geometry.index.count, 24 * 4 * 6);
});

test("the examples do what they say", async () => {
  writeFileSync(at("in.glb"), glb(6));
  const example = (name, ...words) => run(process.execPath, [join(installed.own, "examples", name), ...words], {
    cwd: installed.folder, env: { ...process.env, UNWRAPD_SERVER: server.base } });
  const one = await example("node.mjs", "in.glb", "out.glb");
  assert.match(one.stdout, /^\d+ charts, D_angle 2\.\d+\n$/);
  assert.match(one.stderr, /100 % succeeded/);
  assert.equal(readFileSync(at("out.glb")).toString("latin1", 0, 4), "glTF");
  writeFileSync(at("bad.obj"), "no mesh");
  const many = await example("many.mjs", "in.glb", "bad.obj");
  assert.match(many.stdout, /^in\.glb \d+ charts\nbad\.obj .*\(unknown_format\)\n$/);
  await example("gltf-transform.mjs", "in.glb", "transformed.glb");
  const document = await new NodeIO().read(at("transformed.glb"));
  assert.ok(document.getRoot().listMeshes()[0].listPrimitives()[0].getAttribute("TEXCOORD_0"));
  assert.match((await example("three.mjs")).stdout, /^\d+ vertices, \d+ charts\n$/);
});

test("the types hold what they promise, and refuse what the server would", async () => {
  const good = `import {readFile} from 'node:fs/promises';
    import {unwrap, UnwrapdError, type Report} from 'unwrapd-client';
    import {unwrapd} from 'unwrapd-client/gltf-transform';
    import {unwrapGeometry} from 'unwrapd-client/three';
    const {asset, report} = await unwrap(new Blob(), {preset: 'texture', lambda: [0.1, 1]}, {onProgress: ({event}) =>
      event.event === 'iteration' ? event.data.energy : 0, signal: AbortSignal.timeout(1), key: 'k'});
    const kept: [Blob, Report, string] = [asset, report, new UnwrapdError({detail: '', status: 1, code: ''}).code];
    const read = await unwrap(await readFile('mesh.glb'));
    export {kept, read, unwrapd, unwrapGeometry};`;
  writeFileSync(at("good.mts"), good);
  writeFileSync(at("bad.mts"), good.replace("'texture'", "'textures'"));
  const tsc = new URL("../../node_modules/typescript/bin/tsc", import.meta.url).pathname;
  const flags = ["--strict", "--noEmit", "--target", "es2022", "--module", "nodenext", "--skipLibCheck", "--types", "node"];
  const compiled = run(process.execPath, [tsc, ...flags, "good.mts", "bad.mts"], { cwd: installed.folder });
  await assert.rejects(compiled, ({ stdout }) => /^bad.mts.*'"textures"' is not assignable/m.test(stdout) && !/^good.mts/m.test(stdout));
});

test("the package works in a browser, from another site", { skip: noChromium }, async (t) => {
  const site = createServer((request, response) => {
    const isScript = request.url.endsWith(".js");
    response.setHeader("Content-Type", isScript ? "text/javascript" : "text/html");
    response.end(isScript ? readFileSync(join(installed.own, "dist", request.url)) : "<!DOCTYPE html><title>t</title>");
  });
  await once(site.listen(0, "127.0.0.1"), "listening");
  const playwright = await import("playwright-core");
  const browser = await playwright.chromium.launch({ executablePath: chromium, args: ["--no-sandbox", "--disable-gpu", "--disable-quic"] });
  t.after(async () => {
    await browser.close();
    site.close();
  });
  const page = await browser.newPage();
  await page.goto(`http://127.0.0.1:${site.address().port}/`);
  const told = await page.evaluate(async ([address, bytes]) => {
    const { unwrap } = await import("/index.js");
    const names = [];
    const settings = { server: address, onProgress: ({ event }) => names.push(event.event) };
    const { asset } = await unwrap(new Blob([Uint8Array.from(bytes)]), { preset: "chart" }, settings);
    return { size: asset.size, type: asset.type, names };
  }, [server.base, [...glb(7)]]);
  assert.equal(told.type, "model/gltf-binary");
  assert.ok(told.size > 0 && told.names.includes("iteration") && told.names.at(-1) === "succeeded", JSON.stringify(told));
});

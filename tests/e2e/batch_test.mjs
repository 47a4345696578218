// Several meshes in one command. UNWRAPD_BIN is the folder of the programs.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, renameSync, rmSync, statSync, utimesSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, beforeEach, test } from "node:test";
import { setTimeout as pause } from "node:timers/promises";

const bin = process.env.UNWRAPD_BIN;
const home = mkdtempSync(join(tmpdir(), "unwrap_batch_"));
const kSheet = "v 0 0 0\nv 1 0 0\nv 1 1 .2\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
let folder;

after(() => rmSync(home, { recursive: true }));

beforeEach(() => {
  folder = mkdtempSync(join(home, "in_"));
  mkdirSync(join(folder, "sub"));
  for (const name of ["a.obj", "b.obj", "sub/c.obj"]) writeFileSync(join(folder, name), kSheet);
});

/** Starts unwrap in the folder, without a server. */
function start(...words) {
  const child = spawn(join(bin, "unwrap"), ["--local", "--preset", "chart", ...words], { cwd: folder, stdio: ["ignore", "pipe", "pipe"] });
  const result = { out: "", err: "" };
  child.stdout.on("data", (text) => (result.out += text));
  child.stderr.on("data", (text) => (result.err += text));
  const ended = new Promise((resolve) => child.once("close", (code) => resolve({ ...result, code })));
  return { child, result, ended };
}

const unwrap = (...words) => start(...words).ended;
const uvs = (name) => readFileSync(join(folder, name), "utf8").match(/^vt /gm).length;

test("a folder is unwrapped into another, and told in a table", async () => {
  const run = await unwrap(".", "-o", "out", "-j", "2");
  assert.equal(run.code, 0, run.err);
  for (const name of ["a.obj", "b.obj", "sub/c.obj"]) assert.equal(uvs(join("out", name)), 4);
  assert.match(run.out, /^file +charts +D_angle +D_area +flipped +overlaps +fill +seconds$/m);
  assert.match(run.out, /^\.\/sub\/c\.obj +1 +2\.0\d\d +2\.0\d\d +0 +0 +0\.\d\d +\d+\.\d$/m);
  assert.match(run.out, /^3 done, 0 failed$/m);
  assert.match(run.err, /^\[3\/3\] /m);
});

test("one that fails does not keep the others, and is tried again by --resume alone", async () => {
  writeFileSync(join(folder, "broken.obj"), "v 0 0 0\n");
  const run = await unwrap(".", "missing.obj");
  assert.equal(run.code, 1);
  for (const name of ["a.uv.obj", "b.uv.obj", "sub/c.uv.obj"]) assert.equal(uvs(name), 4);
  assert.match(run.out, /^\.\/broken\.obj +.*no_triangles/m);
  assert.match(run.out, /^missing\.obj +.*missing\.obj/m);
  assert.match(run.out, /^3 done, 2 failed$/m);
  const made = statSync(join(folder, "a.uv.obj")).mtimeMs;
  writeFileSync(join(folder, "broken.obj"), kSheet);
  const again = await unwrap(".", "--resume");
  assert.equal(again.code, 0, again.err);
  assert.match(again.out, /^1 done, 0 failed, 3 there already$/m);
  assert.equal(statSync(join(folder, "a.uv.obj")).mtimeMs, made);
});

test("--json prints a line of JSON for each mesh", async () => {
  writeFileSync(join(folder, "broken.obj"), "v 0 0 0\n");
  const run = await unwrap("a.obj", "broken.obj", "--json", "--quiet");
  assert.equal(run.code, 1);
  const lines = run.out.trim().split("\n").map((line) => JSON.parse(line));
  const [failed, done] = lines.sort((x) => ("failure" in x ? -1 : 1));
  assert.equal(done.out, "a.uv.obj");
  assert.equal(done.report.input.faces, 2);
  assert.match(failed.failure, /no_triangles/);
});

test("--watch unwraps what comes and what changes, each once, until it is stopped", async () => {
  const { child, result, ended } = start(".", "--watch", "-o", "../watched");
  const seen = async (name, times) => {
    const count = () => result.err.split(`./${name}`).length - 1;
    for (let k = 0; k < 600 && count() < times; k += 1) await pause(100);
    assert.equal(count(), times, result.err);
  };
  await seen("sub/c.obj", 1);
  writeFileSync(join(folder, "new.obj"), kSheet);
  await seen("new.obj", 1);
  const later = new Date(Date.now() - 2000);
  utimesSync(join(folder, "a.obj"), later, later);
  await seen("a.obj", 2);
  await pause(2500);
  await seen("new.obj", 1);
  child.kill("SIGINT");
  assert.equal((await ended).code, 130);
  assert.ok(existsSync(join(home, "watched", "new.obj")));
});

test("two files are compared as they are, in a table and on a page", async () => {
  const uv = (scale) => [0, 1, 1, 0].map((u, i) => `vt ${scale * u} ${scale * (i > 1 ? 1 : 0)}\n`).join("");
  const faces = "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
  writeFileSync(join(folder, "half.obj"), kSheet.replace(/^f .*\n/gm, "") + uv(0.5) + faces);
  writeFileSync(join(folder, "folded.obj"), kSheet.replace(/^f .*\n/gm, "") + uv(1) + "f 1/1 2/2 3/3\nf 1/1 3/3 4/2\n");
  renameSync(join(folder, "folded.obj"), join(folder, 'a"<&.obj'));
  const run = await unwrap("compare", "half.obj", 'a"<&.obj', "-o", "both.html", "--layout-colour", "area");
  assert.equal(run.code, 0, run.err);
  assert.match(run.out, /^ +half\.obj +a"<&\.obj$/m);
  assert.match(run.out, /^charts +1 +1$/m);
  assert.match(run.out, /^flipped +0 +1$/m);
  assert.match(run.out, /^overlaps +0 +1$/m);
  assert.match(run.out, /^fill +0\.25 +1\.00$/m);
  const page = readFileSync(join(folder, "both.html"), "utf8");
  assert.equal(page.match(/<svg/g).length, 2);
  assert.equal(page.match(/data:image\/png;base64,iVBOR/g).length, 2);
  assert.match(page, /alt="a&quot;&lt;&amp;\.obj with a checkerboard"/);
  assert.match(page, />area</);
  const both = JSON.parse((await unwrap("compare", "half.obj", 'a"<&.obj', "--json")).out);
  assert.deepEqual(both.map(({ distortion }) => distortion.flipped), [0, 1]);
  const none = await unwrap("compare", "a.obj", "half.obj");
  assert.equal(none.code, 1);
  assert.match(none.err, /a\.obj: It has no texture coordinates to compare; unwrap it first.*no_texture_coordinates/s);
  const nowhere = await unwrap("compare", "half.obj", "half.obj", "-o", "nowhere/both.html");
  assert.equal(nowhere.code, 4, nowhere.err);
  assert.equal((await unwrap("compare", "half.obj", "half.obj", "--quiet")).out, "");
});

test("the picture of several pages shows their borders", async () => {
  writeFileSync(join(folder, "two.obj"), kSheet.replace("f 1 2 3", "usemtl a\nf 1 2 3\nusemtl b"));
  const made = await unwrap("two.obj", "-q", "--group", "material", "--layout", "two.svg");
  assert.equal(made.code, 0, made.err);
  assert.match(readFileSync(join(folder, "two.svg"), "utf8"), /M40960 10240l0 20480/); // right side of the second
});

test("OBJs that become GLBs take their materials and the images of these along", async () => {
  const pixel = Buffer.from("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg==", "base64");
  writeFileSync(join(folder, "a.obj"), `mtllib a.mtl\n${kSheet.replace("f 1", "usemtl wood\nf 1")}`);
  writeFileSync(join(folder, "a.mtl"), "newmtl wood\nKd 1 .5 .2\nmap_Kd wood.png\n");
  writeFileSync(join(folder, "wood.png"), pixel);
  const run = await unwrap("a.obj", "-o", "a.glb");
  assert.equal(run.code, 0, run.err);
  const glb = readFileSync(join(folder, "a.glb"));
  const { images, bufferViews } = JSON.parse(glb.toString("utf8", 20, 20 + glb.readUInt32LE(12)));
  assert.equal(bufferViews[images[0].bufferView].byteLength, pixel.length);
});

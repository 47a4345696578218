// The two programs together, as a user runs them: unwrapd on a free port, unwrap beside it.
// UNWRAPD_BIN is the folder of both.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, before, test } from "node:test";

const bin = process.env.UNWRAPD_BIN;
const folder = mkdtempSync(join(tmpdir(), "unwrap_e2e_"));
const at = (name) => join(folder, name);
let server;
let address;

before(async () => {
  const flags = ["--listen", "127.0.0.1:0", "--data", at("data"), "--workers", "1"];
  server = spawn(join(bin, "unwrapd"), flags, { stdio: ["ignore", "pipe", "ignore"] });
  const lines = createInterface({ input: server.stdout });
  const [line] = await new Promise((resolve) => lines.once("line", (text) => resolve([text])));
  address = line.match(/^unwrapd listening on (http:\/\/127\.0\.0\.1:\d+)$/)[1];
  assert.equal((await unwrap("--sample", at("shell.glb"))).code, 0);
});

after(async () => {
  const gone = new Promise((resolve) => server.once("exit", resolve));
  server.kill("SIGTERM");
  await gone;
  rmSync(folder, { recursive: true });
});

/** Runs unwrap to its end. watch(child, text) sees what it writes on stderr. */
function unwrapWith(environment, words, watch = () => {}) {
  const env = { ...process.env, UNWRAPD_SERVER: address, ...environment };
  const child = spawn(join(bin, "unwrap"), words, { env, stdio: ["ignore", "pipe", "pipe"] });
  const result = { out: "", err: "" };
  child.stdout.on("data", (bytes) => (result.out += bytes));
  child.stderr.on("data", (bytes) => {
    result.err += bytes;
    watch(child, result.err);
  });
  return new Promise((resolve) => child.once("close", (code) => resolve({ ...result, code })));
}

const unwrap = (...words) => unwrapWith({}, words);
const kChart = ["--preset", "chart"]; // one chart, which takes least time

function readGlb(path) {
  const bytes = readFileSync(path);
  assert.equal(bytes.toString("latin1", 0, 4), "glTF");
  const length = bytes.readUInt32LE(12);
  return { json: JSON.parse(bytes.toString("utf8", 20, 20 + length)), bin: bytes.subarray(28 + length) };
}

/** The texture coordinates of the first primitive, checked to lie in the unit square. */
function uvsOf(json, bin) {
  const accessor = json.accessors[json.meshes[0].primitives[0].attributes.TEXCOORD_0];
  const view = json.bufferViews[accessor.bufferView];
  const start = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
  const stride = view.byteStride ?? 8;
  const uvs = [];
  for (let k = 0; k < accessor.count; k += 1)
    for (const half of [0, 4]) uvs.push(bin.readFloatLE(start + k * stride + half));
  for (const value of uvs) assert.ok(value >= 0 && value <= 1, `${value} is outside the page`);
  assert.ok(new Set(uvs).size > 100, "the UVs differ");
  return uvs;
}

/** The sample as .gltf with its buffer in a file of its own. */
function splitSample() {
  const { json, bin } = readGlb(at("shell.glb"));
  json.buffers[0].uri = "shell%20data.bin";
  writeFileSync(at("shell data.bin"), bin.subarray(0, json.buffers[0].byteLength));
  writeFileSync(at("shell.gltf"), JSON.stringify(json));
}

test("the sample comes back with UVs, a report and a picture", async () => {
  const run = await unwrap(at("shell.glb"), "--report", at("report.json"), "--layout", at("layout.svg"));
  assert.equal(run.code, 0, run.err);
  const { json, bin } = readGlb(at("shell.uv.glb"));
  uvsOf(json, bin);
  assert.equal(json.materials[0].name, "shell");
  const report = JSON.parse(readFileSync(at("report.json"), "utf8"));
  assert.equal(report.input.faces, 20164);
  assert.equal(report.input.boundaries, 2);
  for (const { distortion } of report.charts)
    assert.ok(Math.max(distortion.angle, distortion.area) <= report.options.max_distortion);
  assert.equal(report.overlaps, 0);
  assert.deepEqual(report.notes, []);
  assert.match(readFileSync(at("layout.svg"), "utf8"), /<svg[\s\S]*<\/svg>/);
  assert.match(run.out, /shell\.uv\.glb: 20164 faces, \d charts?, D_angle 2\.\d+, .* 0 flipped, 0 overlaps, /);
  assert.match(run.err, /solve chart 1\/\d .*iteration \d+ E /);
  assert.ok(!/[\r\x1b]/.test(run.err), "plain lines where there is no terminal");
});

test("without a server the job runs in the process of unwrap, with the same bytes", async () => {
  const expected = await unwrap(at("shell.glb"), ...kChart, "-o", at("there.glb"));
  assert.equal(expected.code, 0, expected.err);
  const temporary = mkdtempSync(join(folder, "tmp_"));
  const here = { TMPDIR: temporary, UNWRAP_API_KEY: "of another server" };
  const run = await unwrapWith(here, [at("shell.glb"), "--local", ...kChart, "-o", at("here.glb")]);
  assert.equal(run.code, 0, run.err);
  assert.deepEqual(readFileSync(at("here.glb")), readFileSync(at("there.glb")));
  assert.equal(run.out.replace("here", "there"), expected.out);
  const usual = await new Promise((resolve) => {
    const probe = createServer().once("error", () => resolve(false)); // another server is there
    probe.listen(8080, "127.0.0.1", () => probe.close(() => resolve(true)));
  });
  if (usual) {
    const found = await unwrapWith({ ...here, UNWRAPD_SERVER: "" }, [at("shell.glb"), ...kChart, "-o", at("here.glb")]);
    assert.match(found.err, /^No server answers at http:\/\/127\.0\.0\.1:8080: the job runs in this process\.$/m);
    assert.equal(found.code, 0);
  }
  const stopped = await unwrapWith(here, [at("shell.glb"), "--local", "--timeout", "0.01"]);
  assert.equal(stopped.code, 3, stopped.err);
  assert.deepEqual(readdirSync(temporary), []);
});

test("an OBJ comes back as an OBJ with vt", async () => {
  const grid = [];
  for (let y = 0; y < 3; y += 1) for (let x = 0; x < 3; x += 1) grid.push(`v ${x} ${y} ${(x * y) / 4}`);
  const quads = [1, 2, 4, 5].map((i) => `f ${i} ${i + 1} ${i + 4} ${i + 3}`);
  writeFileSync(at("grid.obj"), `# kept\n${grid.join("\n")}\n${quads.join("\n")}\n`);
  const run = await unwrap(at("grid.obj"), "-o", at("grid.uv.obj"), "--method", "asap", "--quiet");
  assert.equal(run.code, 0, run.err);
  assert.equal(run.out + run.err, "");
  const text = readFileSync(at("grid.uv.obj"), "utf8");
  assert.equal(text.match(/^vt /gm).length, 9);
  assert.match(text, /^f (\d+)\/\d+ /m);
  assert.match(text, /# kept/);
});

/** Runs unwrap with these bytes at its standard input. */
function piped(bytes, ...words) {
  const env = { ...process.env, UNWRAPD_SERVER: address };
  const child = spawn(join(bin, "unwrap"), words, { env, cwd: folder, stdio: "pipe" });
  const out = [];
  let err = "";
  child.stdout.on("data", (block) => out.push(block));
  child.stderr.on("data", (text) => (err += text));
  child.stdin.end(bytes);
  return new Promise((resolve) => child.once("close", (code) => resolve({ out: Buffer.concat(out), err, code })));
}

test("a dash is standard input and standard output", async () => {
  const triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  writeFileSync(at("triangle.obj"), triangle);
  const named = await unwrap(at("triangle.obj"), "-o", at("triangle.uv.obj"));
  assert.equal(named.code, 0, named.err);
  const expected = readFileSync(at("triangle.uv.obj"));
  for (const words of [["-"], ["/dev/stdin", "-o", "-"], ["triangle.obj", "-o", "-"]]) {
    const { out, err, code } = await piped(words[0] === "triangle.obj" ? "" : triangle, ...words);
    assert.equal(code, 0, err);
    assert.deepEqual(out, expected, words.join(" "));
    assert.match(err, /\nstandard output: 1 faces, 1 chart, /);
  }
  const glb = await piped(triangle, "-", "--output", "glb", "-q");
  assert.deepEqual([glb.code, glb.err, glb.out.toString("latin1", 0, 4)], [0, "", "glTF"]);
  assert.equal(existsSync(at("-")), false);
});

test("two outputs of one name, or one of the input's, are refused before anything is sent", async () => {
  const before = readFileSync(at("shell.glb"));
  for (const words of [["-o", at("x.glb"), "--report", at("x.glb")], ["-o", at("shell.glb")]]) {
    const run = await unwrapWith({ UNWRAPD_SERVER: "http://127.0.0.1:1" }, [at("shell.glb"), ...words]);
    assert.equal(run.code, 2, run.err);
    assert.match(run.err, /name the same file|names the input/);
  }
  assert.deepEqual(readFileSync(at("shell.glb")), before);
  assert.equal(existsSync(at("x.glb")), false);
});

test("an STL comes back as a GLB, whose report says so", async () => {
  const corner = (x, y) => `vertex ${x} ${y} ${(x * y) / 4}`;
  const facet = (...corners) =>
    ["facet normal 0 0 1", "outer loop", ...corners, "endloop", "endfacet"].join("\n");
  const facets = [[0, 0], [1, 0], [0, 1], [1, 1]].flatMap(([x, y]) => [
    facet(corner(x, y), corner(x + 1, y), corner(x + 1, y + 1)),
    facet(corner(x, y), corner(x + 1, y + 1), corner(x, y + 1))]);
  writeFileSync(at("grid.stl"), `solid grid\n${facets.join("\n")}\nendsolid grid\n`);
  const run = await unwrap(at("grid.stl"), "--report", at("grid.report.json"));
  assert.equal(run.code, 0, run.err);
  const { json } = readGlb(at("grid.uv.glb"));
  assert.equal(json.accessors[json.meshes[0].primitives[0].attributes.TEXCOORD_0].count, 9);
  const report = JSON.parse(readFileSync(at("grid.report.json"), "utf8"));
  assert.ok(report.notes.some(({ code }) => code === "format_changed"));
  const refused = await unwrap(at("grid.stl"), "-o", at("grid.uv.stl"));
  assert.equal(refused.code, 2);
  assert.match(refused.err, /STL has no place for UVs/);
  assert.ok(!existsSync(at("grid.uv.stl")));
});

test("a .gltf takes its buffers along, and any format goes into any other", async () => {
  splitSample();
  const run = await unwrap(at("shell.gltf"), "-o", at("joined.glb"), ...kChart, "--stop-iterations", "3");
  assert.equal(run.code, 0, run.err);
  const { json, bin } = readGlb(at("joined.glb"));
  assert.equal(uvsOf(json, bin).length, 2 * 10224);
  const again = await unwrap(at("shell.gltf"), "-o", at("shell.uv.obj"), ...kChart, "--lambda-units", "paper");
  assert.equal(again.code, 0, again.err);
  assert.match(again.out, /^note \(overlaps\): \d+ pairs of triangles overlap/m);
  assert.match(readFileSync(at("shell.uv.obj"), "utf8"), /^vt /m);
});

test("a list of lambdas writes a file for each and one report with the curve", async () => {
  const words = [...kChart, "--method", "hybrid", "--lambda", "1,0.01", "--stop-iterations", "2"];
  const run = await unwrap(at("shell.glb"), "-o", at("curve.glb"), "--report", at("curve.json"), ...words);
  assert.equal(run.code, 0, run.err);
  const maps = ["curve.1.glb", "curve.0.01.glb"].map((name) => readGlb(at(name)));
  const [first, second] = maps.map(({ json, bin }) => uvsOf(json, bin));
  assert.notDeepEqual(first, second);
  assert.match(run.out, /curve\.1\.glb: .*\n.*curve\.0\.01\.glb: /);
  const { curve } = JSON.parse(readFileSync(at("curve.json"), "utf8"));
  assert.deepEqual(curve.map(({ lambda }) => lambda), [1, 0.01]);
});

test("--constraints puts vertices where its file says, --name names the job", async () => {
  writeFileSync(at("pins.json"), '[{"vertex":0,"uv":[0.25,0.25]},{"at":[1,0,0],"uv":[0.75,0.25]}]');
  writeFileSync(at("square.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  const words = ["-o", at("held.obj"), "--constraints", at("pins.json"), "--name", "Pins 7"];
  const run = await unwrap(at("square.obj"), ...words);
  assert.equal(run.code, 0, run.err);
  const lines = readFileSync(at("held.obj"), "utf8").match(/^vt .*$/gm);
  const uvs = lines.map((line) => line.split(" ").slice(1, 3).map(Number));
  for (const corner of [[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]]) {
    const off = Math.min(...uvs.map(([u, v]) => Math.hypot(u - corner[0], v - corner[1])));
    assert.ok(off < 1e-5, `${corner} in ${JSON.stringify(uvs)}`);
  }
  assert.equal((await (await fetch(`${address}/v1/jobs?name=Pins%207`)).json()).jobs.length, 1);
});

test("--json prints the report and nothing else", async () => {
  const run = await unwrap(at("shell.glb"), "-o", at("json.glb"), "--json", "--preset", "chart");
  assert.equal(run.code, 0, run.err);
  const report = JSON.parse(run.out);
  assert.equal(report.charts.length, 1);
  assert.equal(report.options.preset, "chart");
  assert.ok(report.notes.some(({ code }) => code === "overlaps"), JSON.stringify(report.notes));
  assert.equal(report.solver.name, "unwrapd");
});

test("a mistake on the command line is 2 and names the flag", async () => {
  for (const words of [["--method", "magic"], ["--lambda", "-1"], ["--stop-iterations", "0"], ["--no-such"]]) {
    const run = await unwrap(at("shell.glb"), ...words);
    assert.equal(run.code, 2, words.join(" "));
    assert.match(run.err, new RegExp(words[0].slice(2)));
  }
});

test("what the server refuses is 1 and its problem is told", async () => {
  const limit = await unwrap(at("shell.glb"), "--stop-iterations", "1000000000");
  assert.equal(limit.code, 1);
  assert.match(limit.err, /invalid_option.*\/stop\/iterations/);
  writeFileSync(at("no_mesh.glb"), "this is no mesh");
  const file = await unwrap(at("no_mesh.glb"));
  assert.equal(file.code, 1);
  assert.match(file.err, /code [a-z_]+/);
  assert.ok(!existsSync(at("no_mesh.uv.glb")));
});

test("no server, or another one, is 3", async () => {
  const none = await unwrapWith({ UNWRAPD_SERVER: "http://127.0.0.1:1" }, [at("shell.glb")]);
  assert.equal(none.code, 3);
  assert.match(none.err, /--server/);
  const other = createServer((request, response) => response.end("hello")).listen(0, "127.0.0.1");
  await new Promise((resolve) => other.once("listening", resolve));
  const run = await unwrap(at("shell.glb"), "--server", `127.0.0.1:${other.address().port}`);
  other.close();
  assert.equal(run.code, 3);
});

test("a file that is not there, or cannot be written, is 4", async () => {
  assert.equal((await unwrap(at("nothing.glb"))).code, 4);
  assert.equal((await unwrap(at("shell.glb"), "-o", at("no/such/folder.glb"))).code, 4);
});

async function cancelled(run, code) {
  assert.equal(run.code, code, run.err);
  const id = run.err.match(/the job (\w+) is cancelled/)[1];
  for (;;) {  // the worker notices within one iteration
    const job = await (await fetch(`${address}/v1/jobs/${id}`)).json();
    if (job.state === "running" || job.state === "queued") continue;
    return assert.equal(job.state, "cancelled");
  }
}

test("Ctrl-C cancels the job and is 130", async () => {
  const long = [at("shell.glb"), "-o", at("long.glb"), "--stop-iterations", "10000"];
  const stop = (child, text) => /iteration/.test(text) && child.kill("SIGINT");
  await cancelled(await unwrapWith({}, long, stop), 130);
  assert.deepEqual(readdirSync(folder).filter((name) => name.startsWith("long")), []);
});

test("--timeout cancels the job and is 3", async () => {
  await cancelled(await unwrap(at("shell.glb"), "--stop-iterations", "10000", "--timeout", "0.5"), 3);
});

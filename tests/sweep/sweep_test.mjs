// Every file of the test data through the running server: real assets are answered or refused with a
// reason, hostile ones get what EXPECTED.json says, answers are as valid as what came in. The table
// of refusals is printed. Without the data (UNWRAPD_TEST_DATA) the test is skipped.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { basename, dirname, extname, join, relative } from "node:path";
import { createInterface } from "node:readline";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { measure, trianglesOfGltf, trianglesOfObj } from "./written.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const data = process.env.UNWRAPD_TEST_DATA ?? join(here, "../../../shared/data");
const skip = existsSync(data) ? false : `no test data at ${data}`;
const scratch = mkdtempSync(join(tmpdir(), "unwrapd_sweep_"));
const validator = loadValidator();
let server;
let address;

/** The Khronos validator, or null where the npm packages are not installed. */
function loadValidator() {
  try {
    return createRequire(import.meta.url)("gltf-validator");
  } catch {
    return null;
  }
}

before(async () => {
  const flags = ["--listen", "127.0.0.1:0", "--data", scratch, "--workers", "2"];
  server = spawn(join(process.env.UNWRAPD_BIN, "unwrapd"), flags, {
    stdio: ["ignore", "pipe", "ignore"],
  });
  const lines = createInterface({ input: server.stdout });
  const line = await new Promise((resolve) => lines.once("line", resolve));
  address = line.split(" ").at(-1);
});

after(async () => {
  const gone = new Promise((resolve) => server.once("exit", resolve));
  server.kill("SIGTERM");
  await gone;
  rmSync(scratch, { recursive: true });
});

function filesBelow(folder) {
  return readdirSync(folder)
    .sort()
    .map((name) => join(folder, name))
    .flatMap((path) => (statSync(path).isDirectory() ? filesBelow(path) : [path]));
}

/** The buffers that lie beside a .gltf, by the URI that it uses for them. */
function buffersOf(path) {
  if (extname(path) !== ".gltf") return [];
  try {
    const uris = (JSON.parse(readFileSync(path, "utf8")).buffers ?? []).map((b) => b.uri);
    return uris
      .filter((uri) => uri && !uri.startsWith("data:") && !uri.includes(".."))
      .map((uri) => [uri, join(dirname(path), decodeURIComponent(uri))])
      .filter(([, file]) => existsSync(file) && statSync(file).isFile());
  } catch {
    return []; // no JSON at all: the server shall say so
  }
}

/** Sends one file, waits for its job, returns {status, code, format, bytes}. */
async function unwrap(path, query = "") {
  const form = new FormData();
  form.set("mesh", new Blob([readFileSync(path)]), basename(path));
  for (const [uri, file] of buffersOf(path)) form.append("buffer", new Blob([readFileSync(file)]), uri);
  const posted = await fetch(`${address}/v1/jobs${query}`, { method: "POST", body: form });
  if (posted.status !== 202) return { status: posted.status, code: (await posted.json()).code };
  let job = await posted.json();
  while (["queued", "running"].includes(job.state)) {
    await new Promise((resolve) => setTimeout(resolve, 20));
    job = await (await fetch(`${address}/v1/jobs/${job.id}`)).json();
  }
  if (job.state !== "succeeded") return { status: job.problem.status, code: job.problem.code };
  const result = await fetch(`${address}/v1/jobs/${job.id}/result`);
  const report = await (await fetch(`${address}/v1/jobs/${job.id}/report`)).json();
  return {
    id: job.id,
    status: result.status,
    format: result.headers.get("content-type"),
    bytes: new Uint8Array(await result.arrayBuffer()),
    report,
  };
}

/** How often the validator finds each error; undefined where it cannot look inside. */
async function errorsIn(bytes, resource) {
  const options = {
    ignoredIssues: ["IO_ERROR"], // images are nobody's business here
    maxIssues: 0,
    externalResourceFunction: resource ?? (() => Promise.reject(new Error("not sent"))),
  };
  const { issues } = await validator.validateBytes(bytes, options);
  const counts = new Map();
  for (const { code, severity } of issues.messages)
    if (severity === 0) counts.set(code, (counts.get(code) ?? 0) + 1);
  return counts;
}

async function newErrors(path, answer) {
  if (!validator || !answer.format?.startsWith("model/gltf")) return [];
  const resource = async (uri) =>
    new Uint8Array(readFileSync(join(dirname(path), decodeURIComponent(uri))));
  const before = await errorsIn(new Uint8Array(readFileSync(path)), resource);
  const now = await errorsIn(answer.bytes);
  return [...now.keys()].filter((code) => !before.has(code));
}

/** The triangles of an answer as it is written; of a compressed one as they are in its OBJ. */
async function trianglesWritten({ id, format, bytes, report }) {
  const isPlain = !/KHR_draco|meshopt_compression/.test(Buffer.from(bytes).toString("latin1"));
  if (format.startsWith("model/gltf") && isPlain) return trianglesOfGltf(bytes, report.texcoord);
  if (format === "model/obj") return trianglesOfObj(new TextDecoder().decode(bytes));
  const headers = { accept: "model/obj" };
  const obj = await fetch(`${address}/v1/jobs/${id}/result`, { headers });
  return trianglesOfObj(await obj.text());
}

/** Flips that a reader sees in the polygons of an OBJ which cuts them as fans of another corner. */
function flipsByOtherFans({ format, bytes }) {
  if (format !== "model/obj") return 0;
  const text = new TextDecoder().decode(bytes);
  if (!/^f +\S+ +\S+ +\S+ +\S/m.test(text)) return 0;
  return Math.max(...[1, 2, 3].map((from) => measure(trianglesOfObj(text, from)).flipped));
}

/** Bytes of the largest file whose answer is counted: exact arithmetic takes minutes on large ones. */
const mostCounted = Number(process.env.SWEEP_BYTES ?? 60_000);

/** What the report says of an answer that is not so in the file. */
async function untrueFigures(answer) {
  let counted;
  try {
    counted = measure(await trianglesWritten(answer));
  } catch (error) {
    return [String(error)];
  }
  const { distortion, fill, pages, overlaps, texel_density: density } = answer.report;
  const untrue = [];
  const expect = (name, told, found, by) => {
    if (!(Math.abs(told - found) <= by)) untrue.push(`${name}: told ${told}, found ${found}`);
  };
  expect("flipped", distortion.flipped, counted.flipped, 0);
  expect("flipped by other diagonals", 0, flipsByOtherFans(answer), 0);
  expect("triangles that lost their area", 0, counted.lost, 0);
  expect("triangles without area that span others", 0, counted.stray, 0);
  expect("overlaps", overlaps, counted.overlaps, 0);
  if (counted.overlaps === 0) expect("fill", fill, counted.covered / pages, 1e-5);
  for (const figure of ["angle", "area", "stretch"])
    expect(figure, distortion[figure], counted.distortion[figure], 1e-6 * distortion[figure]);
  expect("texel_density", density, 1024 * counted.density, 1e-6 * density);
  return untrue;
}

test("the counter counts what is wrong on a page", () => {
  const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt .5 0\nvt .5 .5\nvt 0 .5\n";
  const found = (faces) => measure(trianglesOfObj(square + faces));
  const right = found("f 1/1 2/2 3/3 4/4");
  assert.deepEqual([right.flipped, right.lost, right.stray, right.overlaps], [0, 0, 0, 0]);
  assert.equal(right.covered, 0.25);
  assert.ok(Math.abs(right.distortion.angle - 2) < 1e-12 && Math.abs(right.distortion.area - 2) < 1e-12);
  assert.equal(found("f 1/1 3/3 2/2").flipped, 1);
  assert.equal(found("f 1/1 2/2 3/3\nf 2/1 3/2 4/3").overlaps, 1);
  assert.equal(found("f 1/1 2/2 3/3\nf 1/1 2/2 3/3").overlaps, 0); // one triangle, twice
  assert.deepEqual(found("f 1/1 2/2 3/3\nf 1/1 3/3 4/1").lost, 1);
  assert.equal(found("f 1/1 2/2 3/3\nf 1/1 2/4 2/1").stray, 1);
  assert.equal(found("f 1/1 2/2 3/3\nf 1/1 2/2 2/2").stray, 0);
});

test("real assets are answered or refused with a reason", { skip, timeout: 1_700_000 }, async (t) => {
  const documents = ["disk", "closed", "gltf", "paper"]
    .flatMap((folder) => filesBelow(join(data, folder)))
    .filter((path) => [".obj", ".glb", ".gltf"].includes(extname(path)));
  let answered = 0;
  const wrong = [];
  const check = async (path) => {
    const name = relative(data, path);
    const isCounted = statSync(path).size <= mostCounted;
    const answer = await unwrap(path, isCounted ? "" : "?effort=fast"); // tests of core take the time for large ones
    if (answer.status === 200) {
      answered += 1;
      const errors = await newErrors(path, answer);
      if (errors.length) wrong.push(`${name}: new validator errors ${errors}`);
      if (!(answer.report.distortion.angle >= 2)) wrong.push(`${name}: D_angle below 2`);
      if (isCounted)
        for (const figure of await untrueFigures(answer)) wrong.push(`${name}: ${figure}`);
      await new Promise((resolve) => setTimeout(resolve, 1)); // fetch hears of connections that ended
    } else {
      t.diagnostic(`${name}: ${answer.status} ${answer.code}`);
      if (!(answer.status >= 400 && answer.status < 500 && answer.code))
        wrong.push(`${name}: ${answer.status} ${answer.code}`);
    }
  };
  const left = documents.values(); // the server has two workers
  const checkAll = async () => {
    for (const path of left) await check(path);
  };
  await Promise.all([checkAll(), checkAll()]);
  t.diagnostic(`${answered} of ${documents.length} answered`);
  assert.deepEqual(wrong, []);
});

/** Whether an answer is what the text of EXPECTED.json allows. */
function allowed(expected, answer) {
  const refused = answer.status >= 400 && answer.status < 500 && answer.code !== undefined;
  if (answer.status !== 200 && !refused) return false;
  if (/^reject/.test(expected) && !/\b(or|repair|split|two charts|must never open)\b/.test(expected))
    return refused;
  if (/^reject; must never open/.test(expected)) return refused;
  if (/^OK/.test(expected) && !/reject|warn|if accepted/.test(expected)) return !refused;
  return true;
}

/** EXPECTED.json refuses every non-manifold edge; this version splits them and answers. */
const answeredInstead = new Set(["a0_fan_3_faces_one_edge.glb"]);

test("hostile files get what they must", { skip, timeout: 1_700_000 }, async (t) => {
  const folder = join(data, "hostile/made");
  const expected = JSON.parse(readFileSync(join(folder, "EXPECTED.json"), "utf8"));
  const wrong = [];
  for (const [name, text] of Object.entries(expected)) {
    if (!existsSync(join(folder, name))) continue; // some are too big to be kept
    const answer = await unwrap(join(folder, name));
    if (answeredInstead.has(name)) assert.equal(answer.status, 200, name);
    else if (!allowed(text, answer)) wrong.push(`${name}: "${text}", got ${answer.status} ${answer.code}`);
  }
  assert.deepEqual(wrong, []);
  for (const path of ["validator", "tinygltf", "draco_bitstreams"].flatMap((f) => filesBelow(join(data, "hostile", f)))) {
    if (path.endsWith(".json")) continue; // the validator's own reports
    const answer = await unwrap(path);
    if (answer.status !== 200 && !(answer.status < 500 && answer.code))
      wrong.push(`${relative(data, path)}: ${answer.status} ${answer.code}`);
  }
  assert.deepEqual(wrong, []);
  assert.equal((await fetch(`${address}/healthz`)).status, 200);
  t.diagnostic(`${Object.keys(expected).length} made files as expected, the server still answers`);
});

// The npm package against the real server: the same bytes as curl, jobs that outlive the server,
// errors, cancelling, many files. UNWRAPD is the server.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { promisify } from "node:util";

import { grid } from "../../fault/server.mjs";
import { install } from "./installed.mjs";
import { restartable } from "./restartable.mjs";

const data = process.env.UNWRAPD_TEST_DATA ?? new URL("../../../../shared/data", import.meta.url).pathname;
const kFiles = [
  "disk/tiny_square.obj", "disk/hand_lowres.obj", "paper/Balls.obj", "paper/Isis_dABF.obj",
  "closed/spot_control_mesh.obj", "gltf/pmndrs/bunny.glb", "gltf/gltfrs/tests/box_sparse.glb", "gltf/tinygltf/models/box01.glb",
  "gltf/gltfpipeline/2.0/box-morph/box-morph.gltf", "gltf/blenderio/tests/roundtrip/02_node_hierarchy/02_node_hierarchy.gltf",
];
const curl = promisify(execFile);

let server;
let installed;
let client;

before(async () => {
  installed = install();
  client = await installed.load("index.js");
  server = await restartable();
});

after(async () => {
  await server?.end();
  installed?.remove();
});

/** The files beside a .gltf, by URI. */
function buffersOf(path) {
  const { buffers = [], images = [] } = JSON.parse(readFileSync(path, "utf8"));
  const uris = [...buffers, ...images].map(({ uri }) => uri).filter((uri) => uri && !uri.startsWith("data:"));
  return Object.fromEntries(uris.map((uri) => [uri, readFileSync(join(dirname(path), decodeURIComponent(uri)))]));
}

function assetAt(path) {
  const mesh = readFileSync(path);
  return path.endsWith(".gltf") ? { mesh, buffers: buffersOf(path) } : mesh;
}

/** What curl gets for a file, computed anew. */
async function byCurl(path) {
  const parts = ["-F", `mesh=@${path}`, "-F", 'options={"preset":"paper"};type=application/json'];
  if (path.endsWith(".gltf"))
    for (const uri of Object.keys(buffersOf(path)))
      parts.push("-F", `buffer=@${join(dirname(path), decodeURIComponent(uri))};filename=${uri}`);
  const words = ["-sSf", "-H", "Cache-Control: no-cache", ...parts, `${server.base}/v1/unwrap`];
  return (await curl("curl", words, { encoding: "buffer", maxBuffer: 1 << 28 })).stdout;
}

test("ten files come back as curl gets them", { skip: !existsSync(data) && `there is no ${data}` }, async () => {
  for (const path of kFiles.map((name) => join(data, name))) {
    const { asset, report, job } = await client.unwrap(assetAt(path), { preset: "paper" }, { server: server.base });
    const expected = await byCurl(path);
    assert.ok(expected.equals(Buffer.from(await asset.arrayBuffer())), path);
    assert.equal(job.state, "succeeded");
    assert.equal(report.options.preset, "paper");
  }
});

test("a job outlives the server that is killed under it", async () => {
  const seen = [];
  let killed;
  const onProgress = ({ fraction, event }) => {
    seen.push({ fraction, name: event.event, attempt: event.data.attempt });
    if (event.event === "iteration") killed ??= server.kill().then(server.start);
  };
  const mesh = new Blob([grid(60)]);
  const settings = { server: server.base, onProgress };
  const { asset, job } = await client.unwrap(mesh, { preset: "chart", stop: { iterations: 400 } }, settings);
  await killed;
  assert.match(await asset.text(), /^vt /m);
  assert.equal(job.attempt, 2);
  assert.deepEqual(seen.filter(({ name }) => name === "started").map(({ attempt }) => attempt), [1, 2]);
  assert.ok(seen.every(({ fraction }, i) => i === 0 || fraction >= seen[i - 1].fraction), "progress never falls");
  assert.equal(seen.at(-1).fraction, 1);
  const { jobs } = await (await fetch(`${server.base}/v1/jobs?limit=200`)).json();
  assert.equal(jobs.filter(({ options }) => options.stop.iterations === 400).length, 1);
});

test("a job has the name that it was given", async () => {
  const name = "Stuhl „Müller“";
  const { job } = await client.unwrap(new Blob([grid(2)]), {}, { server: server.base, name });
  assert.equal(job.name, name);
  const { jobs } = await (await fetch(`${server.base}/v1/jobs?${new URLSearchParams({ name })}`)).json();
  assert.deepEqual(jobs.map(({ id }) => id), [job.id]);
});

test("a ticket takes a mesh in place of a key, once", async () => {
  const { urls } = await client.uploadTickets({ server: server.base }, { count: 2, seconds: 60, maxBytes: 1e6 });
  const settings = { server: server.base, ticket: urls[0] };
  const { asset, job } = await client.unwrap(new Blob([grid(3)]), {}, settings);
  assert.match(await asset.text(), /^vt /m);
  assert.match(job.links.result, /signature=/);
  await assert.rejects(client.unwrap(new Blob([grid(2)]), {}, settings), { code: "idempotency_conflict" });
  await assert.rejects(client.uploadTickets({ server: server.base }, { count: 101 }), { pointer: "/count" });
});

test("a refusal is an UnwrapdError with code, pointer, detail and status", async () => {
  const settings = { server: server.base };
  await assert.rejects(client.unwrap(new Blob([grid(2)]), { method: "magic" }, settings), (error) => {
    assert.ok(error instanceof client.UnwrapdError);
    assert.deepEqual([error.code, error.pointer, error.status], ["invalid_option", "/method", 422]);
    assert.ok(error.detail.length > 10);
    return true;
  });
  const broken = client.unwrap(new Blob(["v 0 0 0\nf 1 2 3\n"]), {}, settings);
  await assert.rejects(broken, { code: "malformed_obj", status: 400, job: /^j_/ });
  const nobody = client.unwrap(new Blob([grid(2)]), {}, { server: "http://127.0.0.1:1", retries: 1 });
  await assert.rejects(nobody, { name: "UnwrapdError", code: "unreachable", status: 0 });
});

/** The state of a job once it has ended, which takes a cancelled one an iteration. */
async function endOf(id) {
  for (const giveUp = Date.now() + 20_000; Date.now() < giveUp; ) {
    const { state } = await (await fetch(`${server.base}/v1/jobs/${id}`)).json();
    if (!["running", "queued"].includes(state)) return state;
  }
  return "still running";
}

test("a signal ends the call and cancels the job", async () => {
  const stop = new AbortController();
  const onProgress = ({ event }) => {
    if (event.event === "iteration") stop.abort(new Error("enough"));
  };
  const endless = { preset: "chart", stop: { iterations: 10000 } };
  const settings = { server: server.base, signal: stop.signal, onProgress };
  await assert.rejects(client.unwrap(new Blob([grid(100)]), endless, settings), /enough/);
  const { jobs } = await (await fetch(`${server.base}/v1/jobs?limit=1`)).json();
  assert.equal(await endOf(jobs[0].id), "cancelled");
});

test("many assets come back in their order, the broken ones with their errors", async () => {
  const assets = [grid(4), "no mesh", grid(5), grid(6), grid(7)].map((text) => new Blob([text]));
  const settings = { server: server.base, concurrency: 2, options: { preset: "chart" } };
  const outcomes = [];
  for await (const outcome of client.unwrapMany(assets, settings)) outcomes.push(outcome);
  assert.deepEqual(outcomes.map(({ input }) => input), assets);
  assert.deepEqual(outcomes.map(({ report }) => report?.input.faces), [32, undefined, 50, 72, 98]);
  assert.equal(outcomes[1].error.code, "unknown_format");
});

test("whoever stops early cancels the rest", async () => {
  let iterates;
  const iterating = new Promise((resolve) => (iterates = resolve));
  const settings = {
    server: server.base, concurrency: 2, options: { preset: "chart", stop: { iterations: 9999 } },
    onProgress: ({ event }) => event.event === "iteration" && iterates(),
  };
  for await (const { error } of client.unwrapMany([null, new Blob([grid(100)])], settings)) {
    assert.ok(error instanceof TypeError, "null is no asset");
    await iterating;
    break;
  }
  const { jobs } = await (await fetch(`${server.base}/v1/jobs?limit=1`)).json();
  assert.equal(jobs[0].options.stop.iterations, 9999);
  assert.equal(await endOf(jobs[0].id), "cancelled");
});

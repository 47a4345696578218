// Nodes that share no directory: their files are in a bucket of a real object store, which is killed
// while it is written to. No job is lost, every result has the bytes of a node alone, a flipped bit is
// found, and what is removed leaves nothing.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, grid, QUICK, Server } from "../fault/server.mjs";
import { Farm, send, sha256Of } from "../farm/nodes.mjs";
import { slowLink } from "./slow_link.mjs";

const JOBS = 60;
const SIZES = [2, 3, 4, 5];
const PATH = `/v1/jobs?preset=chart&${QUICK}`;
const FLAGS = ["--isolate=off"];
const BIG = `${grid(30)}#${" ".repeat(17_000_000)}\n`; // goes in two parts
/** Where the store is killed: in which request, after how many bytes of it. The first two are of CI. */
const CUTS = [
  { name: "the end of an input in parts", pattern: /^POST \S*uploadId=/, bytes: 100, body: BIG },
  { name: "a result", pattern: /^PUT \S*\/1\/result\./, bytes: 100_000, body: grid(100) },
  { name: "the first part of an input", pattern: /^PUT \S*partNumber=1&/, bytes: 4_000_000, body: BIG },
  { name: "the last part of an input", pattern: /^PUT \S*partNumber=2&/, bytes: 100_000, body: BIG },
  { name: "an input in one piece", pattern: /^PUT \S*\/document /, bytes: 4_000_000, body: BIG.slice(0, -9_000_000) },
].slice(0, process.env.FARM_JOBS ? undefined : 2);

/** Sends a job until it is taken: a store that is away is told by 503. */
async function submit(nodes, k, body = grid(SIZES[k % SIZES.length])) {
  for (let round = 0; ; round++) {
    const headers = { "Idempotency-Key": `job-${k}`, "Cache-Control": "no-cache" };
    const node = nodes()[(k + round) % 2];
    const answer = await send(node, PATH, { body, headers }).catch(() => undefined);
    if (answer?.ok) return (await answer.json()).id;
    if (answer) assert.equal(answer.status, 503, await answer.text());
    await sleep(100);
  }
}

async function taken(answer) {
  const body = await answer.json();
  assert.ok(answer.ok, JSON.stringify(body));
  return body;
}

/** All of it, as subtests of t. store: a Radosgw, or the like. */
export async function useBucket(t, store) {
  t.after(() => store.remove());
  store.s3("PUT", "/jobs");
  const objects = () => [...String(store.s3("GET", "/jobs?list-type=2")).matchAll(/<Key>(.*?)<\/Key>/g)].map(([, key]) => key);
  Object.assign(process.env, store.environment());
  const farm = new Farm(t);
  const link = await slowLink(store.endpoint);
  t.after(link.close);
  farm.blobs = ["--blobs", "s3://jobs/farm", "--s3-endpoint", link.endpoint];

  await t.test("a bucket that cannot be used is told at the start", () => {
    const args = ["--database", farm.url, "--s3-endpoint", store.endpoint, "--listen", "127.0.0.1:0"];
    const start = (...more) =>
      execFileSync(process.env.UNWRAPD, [...args, "--data", dataDirectory(t), ...more], { encoding: "utf8", stdio: "pipe" });
    assert.throws(() => start("--blobs", "s3://none"), /cannot be written to.*NoSuchBucket/s);
    const key = join(dataDirectory(t), "key");
    writeFileSync(key, "TESTKEY\nanother\n");
    assert.throws(() => start("--blobs", "s3://jobs", "--s3-credentials", key), /SignatureDoesNotMatch/);
  });

  const names = ["front-1", "front-2", "worker-1", "worker-2"];
  const start = (name) => farm.start(name, name.startsWith("front") ? 0 : 1, ...FLAGS);
  for (const name of names) await start(name);
  const fronts = () => [farm.nodes.get("front-1"), farm.nodes.get("front-2")];
  const alone = await Server.start(dataDirectory(t));
  const bytesOf = async (size) => sha256Of(await send(alone, `/v1/unwrap?preset=chart&${QUICK}`, { size }));

  await t.test("a file in parts, a mesh of its own, an answer from the store", async () => {
    const big = await taken(await send(fronts()[0], PATH, { body: BIG }));
    const job = await fronts()[1].finished(big.id);
    assert.equal(job.state, "succeeded", JSON.stringify(job));
    const mesh = Buffer.from(grid(7));
    const path = `/v1/meshes/${await sha256Of(new Response(mesh))}`;
    await taken(await send(fronts()[0], path, { method: "PUT", body: mesh }));
    const options = { body: JSON.stringify({ preset: "chart", stop: { iterations: 2 } }), headers: { "Content-Type": "application/json" } };
    const sent = await taken(await send(fronts()[1], `${path}/jobs`, options));
    assert.equal((await fronts()[0].finished(sent.id)).state, "succeeded", JSON.stringify(sent));
    const again = await taken(await send(fronts()[0], `${path}/jobs`, options));
    assert.equal(again.state, "succeeded", "the results of the other job");
    const expected = await bytesOf(7);
    for (const { id } of [sent, again])
      for (const node of fronts())
        assert.equal(await sha256Of(await fetch(`${node.url}/v1/jobs/${id}/result`)), expected);
    assert.equal((await fetch(`${fronts()[1].url}/v1/jobs/${sent.id}/layout.png?size=64`)).status, 200);
  });

  const ids = [];
  await t.test(`${JOBS} jobs outlive kills of nodes and of the store`, async () => {
    farm.countEnds();
    const sending = Promise.all(Array.from({ length: JOBS }, (_, k) => sleep(40 * k).then(() => submit(fronts, k))));
    await sleep(700);
    await store.killGateway();
    await sleep(2000);
    store.startGateway();
    await store.answers();
    for (const name of ["worker-1", "front-2"]) {
      await farm.nodes.get(name).end("SIGKILL");
      await start(name);
    }
    ids.push(...(await sending));
    await farm.allEnd(120);
    assert.equal(new Set(ids).size, JOBS);
    assert.equal(farm.query("SELECT COUNT(*), COUNT(DISTINCT id) FROM ends"), `${JOBS}|${JOBS}`);
    for (const [k, size] of SIZES.entries()) {
      const expected = await bytesOf(size);
      for (let job = k; job < JOBS; job += SIZES.length) {
        const answer = await fetch(`${fronts()[job % 2].url}/v1/jobs/${ids[job]}/result`);
        assert.equal(await sha256Of(answer), expected, `${answer.status} ${ids[job]}`);
      }
    }
  });

  for (const [k, { name, pattern, bytes, body }] of CUTS.entries())
    await t.test(`the store is killed in the middle of ${name}`, async () => {
      const cut = link.cutIn(pattern, bytes, async () => {
        await store.killGateway();
        await sleep(300);
        store.startGateway();
        await store.answers();
      });
      const sent = submit(fronts, JOBS + k, body);
      await cut;
      const { id, state, attempt } = await fronts()[0].finished(await sent);
      assert.deepEqual([state, attempt], ["succeeded", 1]);
      const expected = await sha256Of(await send(alone, `/v1/unwrap?preset=chart&${QUICK}`, { body }));
      for (const node of fronts())
        assert.equal(await sha256Of(await fetch(`${node.url}/v1/jobs/${id}/result`)), expected);
      assert.equal(farm.query("SELECT COUNT(*) - COUNT(DISTINCT id) FROM ends"), "0");
      ids.push(id);
    });
  const unfinished = String(store.s3("GET", "/jobs?uploads=")).match(/<UploadId>/g) ?? [];
  t.diagnostic(`${unfinished.length} uploads in parts were never completed`);

  await t.test("while the store is away, what is known is told, and files are not", async () => {
    const [node] = fronts();
    await store.killGateway();
    assert.equal((await node.job(ids[0])).state, "succeeded");
    await farm.nodes.get("front-1").end("SIGKILL");
    const waits = await fetch(`${fronts()[1].url}/v1/jobs/${ids[0]}`);
    assert.equal(waits.status, 200);
    const sent = await send(fronts()[1], PATH, { size: 9 });
    assert.equal(sent.status, 503);
    assert.ok(Number(sent.headers.get("retry-after")) > 0);
    store.startGateway();
    await store.answers();
    await start("front-1");
  });

  await t.test("a node that ends while its results wait for the store gives the job back", async () => {
    const [node] = fronts();
    const { id } = await taken(await send(node, "/v1/jobs?preset=paper&stop.iterations=1600", { size: 60 }));
    await node.iterates(id);
    const working = farm.nodeOf(id);
    await store.killGateway();
    while (!working.log.includes("results of a job wait")) await sleep(50);
    await working.end("SIGTERM");
    assert.equal(farm.query(`SELECT state FROM jobs WHERE id = '${id}'`), "running", "its lease is over soon");
    store.startGateway();
    await store.answers();
    await start(working.name);
    assert.equal((await node.finished(id)).state, "succeeded");
  });

  await t.test("a flipped bit of a copy is fetched again, one of the store is found", async () => {
    const [node] = fronts();
    const report = `${node.url}/v1/jobs/${ids[1]}/report`;
    const text = await (await fetch(report)).text();
    const file = join(farm.folder, "front-1", "copies", "blobs", ids[1], "report.json");
    const bytes = readFileSync(file);
    bytes[bytes.length >> 1] ^= 1;
    writeFileSync(file, bytes);
    assert.equal(await (await fetch(report)).text(), text);
    const attempt = (name) => Number(name.split("/").at(-2));
    const keys = objects().filter((name) => name.startsWith(`farm/${ids[2]}/`) && name.endsWith("report.json"));
    const key = keys.sort((a, b) => attempt(a) - attempt(b)).at(-1); // of a job that was begun again, the one that counts
    store.s3("PUT", `/jobs/${key}`, "--data-binary", "damaged");
    assert.equal((await (await fetch(`${fronts()[0].url}/v1/jobs/${ids[2]}/report`)).json()).code, "storage_corrupt");
  });

  await t.test("a name that is used again is not answered with the copies of before", async () => {
    const id = `j_${"ab".repeat(16)}`;
    const put = (node, size) => send(node, `/v1/jobs/${id}?preset=chart&${QUICK}`, { method: "PUT", size });
    const results = [];
    for (const [k, size] of SIZES.entries()) {
      const [one, two] = k % 2 === 0 ? fronts() : fronts().reverse();
      assert.ok((await put(one, size)).ok);
      await two.finished(id);
      results.push(await sha256Of(await fetch(`${two.url}/v1/jobs/${id}/result`)));
      assert.equal((await fetch(`${one.url}/v1/jobs/${id}/layout.svg`)).status, 200);
      await fetch(`${two.url}/v1/jobs/${id}`, { method: "DELETE" });
      // the next upload comes while that is being removed
    }
    assert.deepEqual(results, await Promise.all(SIZES.map(bytesOf)));
  });

  await t.test("what is removed leaves nothing", async () => {
    await Promise.all(ids.map((id, k) => fetch(`${fronts()[k % 2].url}/v1/jobs/${id}`, { method: "DELETE" })));
    const left = () => objects().filter((key) => ids.some((id) => key.startsWith(`farm/${id}/`)));
    for (const giveUp = Date.now() + 120_000; left().length > 0; await sleep(100)) assert.ok(Date.now() < giveUp, left().join());
    assert.deepEqual(readdirSync(join(farm.folder, "front-1", "copies", "incoming")), []);
  });
}

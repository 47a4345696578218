// The work of a large scene is shared by the workers that have no job: the same bytes for any number of
// them, whoever is killed, and no worker waits for another that has no place.
import assert from "node:assert/strict";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { scene } from "../bench/made_scene.mjs";
import { freePort } from "../fault/free_port.mjs";
import { dataDirectory, ENDLESS, Server } from "../fault/server.mjs";
import { Farm, options, send, sha256Of } from "./nodes.mjs";

const SCENE = scene(150, 10, 18); // 120,000 faces
const PATH = "/v1/jobs?effort=fast&max_distortion=2.02";
const GLB = { "Content-Type": "model/gltf-binary" };

async function submit(node, path = PATH) {
  const answer = await send(node, path, { headers: { ...GLB, "Cache-Control": "no-cache" }, body: SCENE });
  assert.equal(answer.status, 202, await answer.clone().text());
  return (await answer.json()).id;
}

/** The digest of a job's result, once it has ended. */
async function resultOf(node, id) {
  const job = await node.finished(id);
  assert.equal(job.state, "succeeded", JSON.stringify(job));
  return sha256Of(await fetch(`${node.url}/v1/jobs/${id}/result`));
}

/** What a node alone makes of the scene, without any sharing: asked once for all tests. */
let alone;
async function expected(t) {
  alone ??= (async () => {
    const adminPort = await freePort();
    const node = Object.assign(await Server.start(dataDirectory(t), "--admin-listen", `127.0.0.1:${adminPort}`), { adminPort });
    const result = await resultOf(node, await submit(node));
    assert.equal((await bundles([node])).offered, 0, "a worker that is alone shares nothing");
    await node.end("SIGTERM");
    return result;
  })();
  return alone;
}

async function startWorker(farm, name) {
  const adminPort = await freePort();
  return Object.assign(await farm.start(name, 1, "--admin-listen", `127.0.0.1:${adminPort}`), { adminPort });
}

/** Bundles of all these nodes, by outcome. */
async function bundles(nodes) {
  const counts = { offered: 0, helped: 0, found: 0, lost: 0 };
  for (const node of nodes) {
    const text = await (await fetch(`http://127.0.0.1:${node.adminPort}/metrics`)).text();
    for (const [, outcome, count] of text.matchAll(/^unwrapd_shared_bundles_total{outcome="(\w+)"} (\d+)$/gm)) counts[outcome] += Number(count);
  }
  return counts;
}

const leftOver = (farm) => Number(farm.query("SELECT (SELECT COUNT(*) FROM shared_stages) + (SELECT COUNT(*) FROM shared_bundles)"));

/** Waits until a helper has begun a bundle, which it has not handed over: the node that helps. */
async function helperAtWork(farm, job, nodes) {
  for (const giveUp = Date.now() + 120_000; Date.now() < giveUp; await sleep(40)) {
    const owner = farm.query(`SELECT node FROM jobs WHERE id = '${job}' AND state = 'running'`);
    const begun = farm.query("SELECT COALESCE(SUM(from_back), 0) FROM shared_stages");
    if (owner && Number(begun) > 0) return nodes.find((node) => node.id !== owner);
  }
  assert.fail("nobody helps");
}

/** All events of a job, as its readers see them. */
async function eventsOf(node, id) {
  const text = await (await fetch(`${node.url}/v1/jobs/${id}/events`)).text();
  return [...text.matchAll(/^event: (\w+)\ndata: (.*)$/gm)].map(([, name, data]) => ({ name, ...JSON.parse(data) }));
}

test("the workers of one node share a scene", async (t) => {
  const adminPort = await freePort();
  const flags = ["--workers", "2", "--threads", "1", "--admin-listen", `127.0.0.1:${adminPort}`];
  const node = Object.assign(await Server.start(dataDirectory(t), ...flags), { adminPort });
  assert.equal(await resultOf(node, await submit(node)), await expected(t));
  const counts = await bundles([node]);
  t.diagnostic(JSON.stringify(counts));
  assert.ok(counts.found > 0, JSON.stringify(counts)); // on a busy machine some are waited for in vain
  await node.end("SIGTERM");
});

test("a scene has the same bytes for two and four workers as for one", options, async (t) => {
  const farm = new Farm(t);
  const front = await farm.start("front", 0);
  const workers = [];
  for (const count of [2, 4]) {
    while (workers.length < count) workers.push(await startWorker(farm, `worker-${workers.length}`));
    await sleep(1500); // until the nodes have told of their workers
    const before = await bundles(workers);
    const id = await submit(front);
    const [result, events] = await Promise.all([resultOf(front, id), eventsOf(front, id)]);
    assert.equal(result, await expected(t), `${count} workers`);
    const after = await bundles(workers);
    const counted = Object.fromEntries(Object.keys(after).map((key) => [key, after[key] - before[key]]));
    t.diagnostic(`${count} workers: ${JSON.stringify(counted)}`);
    assert.ok(counted.found > 0 && counted.helped >= counted.found, JSON.stringify(counted));
    const told = events.filter((event) => event.fraction !== undefined);
    assert.ok(told.length > 100 && told.every((event, k) => k === 0 || event.fraction >= told[k - 1].fraction), "progress goes back");
    const charts = events.filter((event) => event.name === "iteration").map((event) => event.chart);
    assert.ok(charts.every((chart, k) => k === 0 || chart >= charts[k - 1]), "charts are told in another order");
  }
  assert.equal(leftOver(farm), 0);
});

/** A farm of two workers, of which one works on a scene, `id`, and the other helps. */
async function farmThatShares(t) {
  const farm = new Farm(t);
  const front = await farm.start("front", 0);
  const nodes = [await startWorker(farm, "one"), await startWorker(farm, "two")];
  await sleep(1500);
  const id = await submit(front);
  const helper = await helperAtWork(farm, id, nodes);
  return { farm, front, id, helper, owner: nodes.find((node) => node !== helper) };
}

test("a helper that is killed costs time only", options, async (t) => {
  const { farm, front, id, helper, owner } = await farmThatShares(t);
  await helper.end("SIGKILL");
  assert.equal(await resultOf(front, id), await expected(t));
  assert.equal(farm.query(`SELECT attempt FROM jobs WHERE id = '${id}'`), "1");
  t.diagnostic(JSON.stringify(await bundles([owner])));
  assert.equal(leftOver(farm), 0);
});

test("where the node of the job is killed, the next attempt finds what was made", options, async (t) => {
  const { farm, front, id, owner } = await farmThatShares(t);
  await owner.end("SIGKILL");
  assert.equal(await resultOf(front, id), await expected(t));
  assert.equal(farm.query(`SELECT attempt FROM jobs WHERE id = '${id}'`), "2");
  assert.equal(leftOver(farm), 0);
});

test("a helper leaves at once where its job is cancelled", async (t) => {
  const node = await Server.start(dataDirectory(t), "--workers", "2", "--threads", "1", "--log-level", "info");
  const body = scene(2, 200, 200); // two bundles, each of which takes longer than this test
  const job = await (await send(node, "/v1/jobs?effort=best&max_distortion=2.001", { headers: GLB, body })).json();
  await node.until(job.id, () => node.log.includes("helping with a job"));
  await sleep(5000); // the helper has read the scene and begun its bundle
  assert.equal((await node.job(job.id)).state, "running");
  const path = (id) => `${node.url}/v1/jobs/${id}`;
  await fetch(path(job.id), { method: "DELETE" });
  const [query, size] = ENDLESS;
  const both = [];
  for (const padding of [2, 3]) both.push((await (await send(node, `/v1/jobs?preset=paper&${query}&padding=${padding}`, { size })).json()).id);
  const begun = Date.now();
  for (const id of both) await node.until(id, ({ state }) => state === "running");
  t.diagnostic(`both workers were there after ${Date.now() - begun} ms`);
  assert.ok(Date.now() - begun < 10_000);
  for (const id of both) await fetch(path(id), { method: "DELETE" });
  await node.end("SIGTERM");
});

test("a full farm helps nobody, and all jobs end", options, async (t) => {
  const farm = new Farm(t);
  const front = await farm.start("front", 0);
  await startWorker(farm, "one");
  await startWorker(farm, "two");
  await sleep(1500);
  const scenes = [await submit(front), await submit(front, `${PATH}&padding=3`), await submit(front, `${PATH}&padding=4`)];
  const small = await Promise.all(Array.from({ length: 20 }, (_, k) => send(front, `/v1/jobs?preset=chart&padding=${k}`)));
  assert.ok(small.every((answer) => answer.status === 202));
  await farm.allEnd(400);
  assert.equal(farm.query("SELECT COUNT(*) FROM jobs WHERE state <> 'succeeded' OR attempt <> 1"), "0");
  assert.equal(await resultOf(front, scenes[0]), await expected(t));
  assert.equal(leftOver(farm), 0);
});

// Many small jobs while the server is killed again and again: each accepted job ends exactly once in
// the right result, none is lost, and nothing else is left on the disk. FAULT_JOBS, FAULT_KILLS and
// FAULT_SEED choose how many and when; `./dev fault` runs the whole.
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, filesBelow, grid, QUICK, Server } from "./server.mjs";

const JOBS = Number(process.env.FAULT_JOBS ?? 200);
const KILLS = Number(process.env.FAULT_KILLS ?? 5);
const SEED = Number(process.env.FAULT_SEED ?? 1);
const SENDERS = 8;
const MESHES = [2, 3, 4, 5, 6].map(grid);
const FLAGS = ["--workers", "2", "--threads", "1", "--max-queue", "100000"];
const PATH = `/v1/jobs?${QUICK}`;

/** Numbers in [0, 1): mulberry32. */
function random(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** The server of this moment; requests that it does not answer are sent again to the next. */
class Current {
  constructor(data) {
    this.data = data;
  }
  async start() {
    this.server = await Server.start(this.data, ...FLAGS);
  }
  async kill() {
    const { server } = this;
    this.server = undefined;
    await server.end("SIGKILL");
    await this.start();
  }
  /** The answer, whichever server gives it. */
  async fetch(path, options, take = (answer) => answer.json()) {
    for (;;) {
      try {
        const answer = await fetch(`${this.server.url}${path}`, options);
        const body = await take(answer);
        if (answer.status < 500) return { status: answer.status, body };
      } catch {
        // the server is dead, or has died in the middle of its answer
      }
      await sleep(10);
    }
  }
}

/** Sends job k until it is accepted; every other sender waits for the end, too. */
async function send(current, k) {
  const headers = {
    "Content-Type": "model/obj",
    "Cache-Control": "no-cache", // each job is to be run
    "Idempotency-Key": `job-${k}`,
    ...(k % 2 ? { Prefer: "wait=5" } : {}),
  };
  const options = { method: "POST", headers, body: MESHES[k % MESHES.length] };
  const { status, body } = await current.fetch(PATH, options);
  assert.ok(status === 200 || status === 202, `job ${k}: ${status} ${JSON.stringify(body)}`);
  return body.id;
}

/** All jobs of the server, page by page. */
async function listed(current) {
  const jobs = [];
  for (let query = "limit=200"; query; ) {
    const { body } = await current.fetch(`/v1/jobs?${query}`);
    jobs.push(...body.jobs);
    query = body.next && `limit=200&cursor=${body.next}`;
  }
  return jobs;
}

async function expectedResults(t) {
  const server = await Server.start(dataDirectory(t), ...FLAGS);
  const results = [];
  for (const mesh of MESHES) {
    const headers = { "Content-Type": "model/obj", Prefer: "wait=60" };
    const answer = await fetch(`${server.url}${PATH}`, { method: "POST", headers, body: mesh });
    const { links } = await answer.json();
    results.push(await (await fetch(`${server.url}${links.result}`)).text());
  }
  await server.end("SIGTERM");
  return results;
}

test(`${JOBS} jobs through ${KILLS} deaths end once each, all in the right result`, async (t) => {
  const expected = await expectedResults(t);
  const data = dataDirectory(t);
  const current = new Current(data);
  await current.start();
  const ids = [];
  let next = 0;
  let accepted = 0;
  const senders = Array.from({ length: SENDERS }, async () => {
    while (next < JOBS) {
      const k = next++;
      ids[k] = await send(current, k);
      ++accepted;
    }
  });
  const killer = (async () => {
    const draw = random(SEED);
    const moments = Array.from({ length: KILLS }, () => draw() * 0.95 * JOBS).sort((a, b) => a - b);
    for (const moment of moments) {
      while (accepted < moment) await sleep(2);
      await sleep(draw() * 60); // into whatever is going on
      await current.kill();
    }
  })();
  await Promise.all([...senders, killer]);

  let reruns = 0;
  for (let k = 0; k < JOBS; ++k) {
    const job = await current.server.finished(ids[k]);
    assert.equal(job.state, "succeeded", JSON.stringify(job));
    reruns += job.attempt - 1;
    const { body } = await current.fetch(job.links.result, {}, (answer) => answer.text());
    assert.ok(body === expected[k % MESHES.length], `the result of job ${k} is another`);
  }
  t.diagnostic(`${JOBS} jobs, ${KILLS} deaths, ${reruns} attempts cut off and made again`);
  const all = (await listed(current)).map(({ id }) => id);
  assert.equal(new Set(ids).size, JOBS, "no two requests got one job");
  assert.deepEqual([...all].sort(), [...ids].sort(), "no job but those that were sent");

  await current.kill();
  assert.deepEqual(readdirSync(join(data, "blobs")).sort(), [...ids].sort());
  assert.deepEqual(filesBelow(join(data, "incoming")), []);
  assert.deepEqual(filesBelow(join(data, "blobs")).filter((name) => name.endsWith(".part")), []);
  for (const id of ids) await current.fetch(`/v1/jobs/${id}`, { method: "DELETE" }, (a) => a.text());
  assert.deepEqual(readdirSync(join(data, "blobs")), [], "no orphan is left");
  assert.deepEqual(await current.server.end("SIGTERM"), [0, null]);
});

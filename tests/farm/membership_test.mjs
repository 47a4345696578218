// Which servers may work on one store together, and how one node becomes several.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, renameSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";

import { dataDirectory, QUICK, Server } from "../fault/server.mjs";
import { Farm, options, send, sha256Of } from "./nodes.mjs";

const MADE_ONCE = `/v1/jobs?preset=chart&${QUICK}`;

test("a worker without a port does what others were sent", options, async (t) => {
  const farm = new Farm(t);
  const front = await farm.start("front", 0);
  const worker = await farm.startWorker("worker");
  assert.equal(worker.url, "unwrapd works on the jobs of other nodes");
  const answer = await send(front, `/v1/unwrap?preset=chart&${QUICK}`);
  assert.equal(answer.status, 200);
  const sessions = farm.query(`SELECT COUNT(*) FROM pg_stat_activity WHERE backend_type = 'client backend'
    AND pid <> pg_backend_pid()`);
  assert.equal(sessions, "6", "each node has three");
  assert.deepEqual(await worker.end("SIGTERM"), [0, null]);
  await assert.rejects(Server.startAs(["worker"], {}, dataDirectory(t)), /--database and --blobs/);
});

test("one node becomes a farm, and keeps what it had", options, async (t) => {
  const farm = new Farm(t);
  const data = join(farm.folder, "front");
  const run = (...args) => execFileSync(process.env.UNWRAPD, args, { encoding: "utf8", stdio: "pipe" });
  const key = run("keys", "add", "--data", data, "--name", "k", "--scopes", "admin").trim().split("\n").at(-1);
  const headers = { Authorization: `Bearer ${key}` };
  const alone = await Server.start(data, "--require-keys");
  const done = await (await send(alone, MADE_ONCE, { headers: { ...headers, Prefer: "wait=60" } })).json();
  assert.equal(done.state, "succeeded");
  const expected = await sha256Of(await fetch(`${alone.url}/v1/jobs/${done.id}/result`, { headers }));
  const link = await (await fetch(`${alone.url}/v1/jobs/${done.id}/link?file=result`, { headers })).json();
  const named = { ...headers, "Idempotency-Key": "slow" };
  const slow = await (await send(alone, "/v1/jobs?preset=paper&stop.iterations=9000", { size: 60, headers: named })).json();
  assert.throws(() => run("move", "--data", data, "--database", farm.url), /cannot be locked/);
  await alone.end("SIGKILL");

  assert.match(run("move", "--data", data, "--database", farm.url), /^moved: 2 jobs and meshes/);
  assert.throws(() => run("move", "--data", data, "--database", farm.url), /There is no /);
  mkdirSync(farm.shared);
  for (const part of ["blobs", "digests-noted"]) renameSync(join(data, part), join(farm.shared, part));
  const front = await farm.start("front", 0, "--require-keys");
  await farm.start("worker", 1, "--require-keys");
  assert.equal(await sha256Of(await fetch(`${front.url}/v1/jobs/${done.id}/result`, { headers })), expected);
  assert.equal(await sha256Of(await fetch(front.url + link.url)), expected);
  const again = await (await send(front, "/v1/jobs?preset=paper&stop.iterations=9000", { size: 60, headers: named })).json();
  assert.equal(again.id, slow.id);
  await farm.allEnd();
  assert.equal(farm.query("SELECT string_agg(state, ' ') FROM jobs"), "succeeded succeeded");
  const next = await (await send(front, MADE_ONCE, { size: 7, headers })).json();
  assert.equal(farm.query(`SELECT seq FROM jobs WHERE id = '${next.id}'`), "3");
});

test("nodes that do not belong together refuse to start", options, async (t) => {
  const farm = new Farm(t);
  const first = await farm.start("first", 1);
  const refused = async (what, ...flags) => {
    const all = ["--database", farm.url, "--log-level", "error", ...flags];
    await assert.rejects(Server.start(dataDirectory(t), ...all), what);
  };
  await refused(/another unwrapd uses it/);
  await first.end("SIGTERM");
  const alone = await Server.start(dataDirectory(t), "--database", farm.url);
  await refused(/an unwrapd without --blobs uses it/, "--blobs", `dir:${farm.shared}`);
  await alone.end("SIGTERM");
});

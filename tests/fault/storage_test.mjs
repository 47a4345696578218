// Disks that are full or return other bytes than were written, and clocks that are set: jobs wait,
// or say what is wrong, and what was stored stays right.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, readFileSync, rmSync, statfsSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, ENDLESS, FAKETIME, grid, QUICK, Server, smallDisk } from "./server.mjs";


/** Changes one byte in the middle of a file. */
function damage(file) {
  const bytes = readFileSync(file);
  bytes[bytes.length >> 1] ^= 1;
  writeFileSync(file, bytes);
}

const problemOf = async (answer) => ({ status: answer.status, code: (await answer.json()).code });

test("a damaged upload fails its job with storage_corrupt", async (t) => {
  const data = dataDirectory(t);
  const server = await Server.start(data);
  const busy = await server.submit(...ENDLESS);
  await server.iterates(busy);
  const id = await server.submit(QUICK, 5);
  damage(join(data, "blobs", id, "document"));
  await fetch(`${server.url}/v1/jobs/${busy}`, { method: "DELETE" });
  const job = await server.finished(id);
  assert.deepEqual([job.state, job.problem.code], ["failed", "storage_corrupt"]);
  await server.end("SIGTERM");
});

test("a damaged result is made again from the map, and refused when that is damaged too", async (t) => {
  const data = dataDirectory(t);
  const server = await Server.start(data);
  const id = await server.submit(QUICK, 5);
  const { links } = await server.finished(id);
  const result = () => fetch(`${server.url}${links.result}`);
  const right = await (await result()).text();
  damage(join(data, "blobs", id, "result.obj"));
  assert.equal(await (await result()).text(), right);
  damage(join(data, "blobs", id, "report.json"));
  const report = await problemOf(await fetch(`${server.url}${links.report}`));
  assert.deepEqual(report, { status: 500, code: "storage_corrupt" });
  damage(join(data, "blobs", id, "result.obj"));
  damage(join(data, "blobs", id, "uv.bin"));
  assert.deepEqual(await problemOf(await result()), { status: 500, code: "storage_corrupt" });
  await server.end("SIGTERM");
});

const REPORT_AND_ALL = ["report.json", "totals.json", "uv.bin", "result.obj", "digests"];

test("a damaged result answers no later job: the same question is then worked out anew", async (t) => {
  const data = dataDirectory(t);
  const server = await Server.start(data);
  const read = async (link) => {
    const answer = await fetch(`${server.url}${link}`);
    return { status: answer.status, text: await answer.text() };
  };
  let last = await server.finished(await server.submit(QUICK, 5));
  const right = (await read(last.links.result)).text;
  for (const file of REPORT_AND_ALL) {
    damage(join(data, "blobs", last.id, file));
    const next = await server.finished(await server.submit(QUICK, 5));
    assert.deepEqual([next.state, next.attempt], ["succeeded", 1], file);
    assert.equal((await read(next.links.report)).status, 200, file);
    assert.equal((await read(next.links.result)).text, right, file);
    last = next;
  }
  const same = await server.finished(await server.submit(QUICK, 5));
  assert.deepEqual([same.state, same.attempt], ["succeeded", 0], "what is whole is an answer");
  writeFileSync(join(data, "blobs", same.id, "digests"), "");
  const report = await problemOf(await fetch(`${server.url}${same.links.report}`));
  assert.deepEqual(report, { status: 500, code: "storage_corrupt" });
  await server.end("SIGTERM");
});

test("a full disk refuses with 507, and every accepted job ends well once there is room", async (t) => {
  const disk = smallDisk(t, 8);
  if (!disk) return t.skip("this user may not mount a file system");
  const data = join(disk, "data");
  const ballast = join(disk, "ballast");
  const server = await Server.start(data, "--min-free-bytes", "0");
  const first = await server.finished(await server.submit(QUICK, 40));
  const right = await (await fetch(`${server.url}${first.links.result}`)).text();
  const { bavail, bsize } = statfsSync(disk);
  writeFileSync(ballast, Buffer.alloc(bavail * bsize - 700_000));

  const ids = [];
  const refusals = new Set();
  for (let k = 0; k < 60; ++k) {
    const answer = await fetch(`${server.url}/v1/jobs?${QUICK}`, {
      method: "POST",
      headers: { "Content-Type": "model/obj", "Cache-Control": "no-cache", "Idempotency-Key": `full-${k}` },
      body: grid(40),
    });
    const body = await answer.json();
    if (answer.status === 202) ids.push(body.id);
    else refusals.add(`${answer.status} ${body.code}`);
  }
  assert.deepEqual([...refusals], ["507 storage_full"]);
  assert.ok(ids.length > 0, "some jobs were accepted before the disk was full");
  rmSync(ballast);
  for (const id of ids) {
    const job = await server.finished(id);
    assert.equal(job.state, "succeeded", JSON.stringify(job));
    assert.equal(await (await fetch(`${server.url}${job.links.result}`)).text(), right);
  }
  await server.end("SIGTERM");
  const again = await Server.start(data, "--min-free-bytes", "0");
  for (const id of [first.id, ...ids]) assert.equal((await again.job(id)).state, "succeeded");
  await again.end("SIGTERM");
});

test("a file beyond `ulimit -f` is refused with 507, and the server goes on", async (t) => {
  const server = await Server.start(dataDirectory(t));
  execFileSync("prlimit", ["--pid", String(server.process.pid), "--fsize=400000"]);
  const post = (size) => fetch(`${server.url}/v1/jobs?${QUICK}`, {
    method: "POST",
    headers: { "Content-Type": "model/obj" },
    body: grid(size),
  });
  assert.deepEqual(await problemOf(await post(120)), { status: 507, code: "storage_full" });
  assert.equal((await server.finished((await (await post(5)).json()).id)).state, "succeeded");
  await server.end("SIGTERM");
});

test("a server whose store cannot be written does not start, and names it", async (t) => {
  const data = dataDirectory(t);
  await (await Server.start(data)).end("SIGTERM");
  const store = join(data, "jobs.sqlite");
  const mount = (...args) => spawnSync("mount", [...args, store]).status === 0;
  if (!mount("--bind", store)) return t.skip("this user may not mount a file system");
  assert.ok(mount("-o", "remount,bind,ro"));
  const run = spawnSync(process.env.UNWRAPD, ["--listen", "127.0.0.1:0", "--data", data], {
    encoding: "utf8",
    timeout: 60_000,
  });
  execFileSync("umount", [store]);
  assert.equal(run.status, 1, run.stderr);
  assert.match(run.stderr, /jobs\.sqlite.*readonly/);
});

test("the disk quota gives up the results that ended first, and refuses what can never fit", async (t) => {
  const server = await Server.start(dataDirectory(t), "--max-disk-bytes", "2000000");
  const ids = [];
  for (let k = 0; k < 8; ++k) {
    const headers = { "Content-Type": "model/obj", "Cache-Control": "no-cache" };
    const answer = await fetch(`${server.url}/v1/jobs?${QUICK}`, { method: "POST", headers, body: grid(50) });
    assert.equal(answer.status, 202);
    ids.push((await server.finished((await answer.json()).id)).id);
  }
  const status = async (id) => (await fetch(`${server.url}/v1/jobs/${id}/result`)).status;
  assert.equal(await status(ids[0]), 410);
  assert.equal(await status(ids[7]), 200);
  const tooLarge = await fetch(`${server.url}/v1/jobs`, {
    method: "POST",
    headers: { "Content-Type": "model/obj" },
    body: grid(250),
  });
  assert.deepEqual(await problemOf(tooLarge), { status: 507, code: "storage_full" });
  const form = new FormData();
  form.set("mesh", new Blob([grid(200)], { type: "model/obj" }), "grid.obj");
  const tooLargeForm = await fetch(`${server.url}/v1/jobs`, { method: "POST", body: form });
  assert.deepEqual(await problemOf(tooLargeForm), { status: 507, code: "storage_full" });
  assert.equal(await status(ids[7]), 200, "nothing is given up for what is refused");
  await server.end("SIGTERM");
});

test("what is beyond a key's quota takes nobody's result away, and the same may be sent again", async (t) => {
  const data = dataDirectory(t);
  const server = await Server.start(data, "--max-disk-bytes", "2000000", "--require-keys");
  const keyOf = (name, ...limits) => {
    const add = ["keys", "add", "--data", data, "--name", name, ...limits];
    const key = execFileSync(process.env.UNWRAPD, add, { encoding: "utf8" }).trim().split("\n").at(-1);
    return { Authorization: `Bearer ${key}`, "Content-Type": "model/obj" };
  };
  const modest = keyOf("modest");
  const greedy = keyOf("greedy", "--max-bytes", "100000");
  const send = async (headers, path, method, body) => {
    const duplex = body instanceof ReadableStream ? "half" : undefined;
    return problemOf(await fetch(`${server.url}${path}`, { method, headers, body, duplex }));
  };
  const run = { method: "POST", headers: { ...modest, "Cache-Control": "no-cache" }, body: grid(50) };
  for (let k = 0; k < 6; ++k) assert.equal((await fetch(`${server.url}/v1/unwrap?${QUICK}`, run)).status, 200);
  const { jobs } = await (await fetch(`${server.url}/v1/jobs`, { headers: modest })).json();
  const statuses = () => Promise.all(jobs.map(async ({ links }) =>
    (await fetch(`${server.url}${links.result}`, { headers: modest })).status));
  const before = await statuses();
  assert.ok(before.includes(200));
  const large = grid(120);
  const beyond = { status: 507, code: "quota_exceeded" };
  assert.deepEqual(await send(greedy, "/v1/jobs", "POST", large), beyond);
  assert.deepEqual(await send(greedy, "/v1/jobs", "POST", new Blob([large]).stream()), beyond);
  assert.deepEqual(await send(greedy, `/v1/meshes/${"0".repeat(64)}`, "PUT", large), beyond);
  assert.deepEqual(await statuses(), before);
  const named = { ...greedy, "Idempotency-Key": "one", Prefer: "wait=60" };
  const post = () => fetch(`${server.url}/v1/jobs?${QUICK}`, { method: "POST", headers: named, body: grid(20) });
  const first = await (await post()).json();
  assert.equal(first.state, "succeeded", JSON.stringify(first.problem));
  assert.deepEqual(await send(greedy, `/v1/jobs?${QUICK}`, "POST", grid(20)), beyond);
  assert.equal((await (await post()).json()).id, first.id);
  await server.end("SIGTERM");
});

/** A file that says what time of day it is ("+10d"), and the environment of a server that believes it. */
function settableClock(t) {
  const clock = join(dataDirectory(t), "clock");
  writeFileSync(clock, "+0");
  const env = {
    LD_PRELOAD: FAKETIME,
    FAKETIME_TIMESTAMP_FILE: clock,
    FAKETIME_NO_CACHE: "1",
    FAKETIME_DONT_FAKE_MONOTONIC: "1",
  };
  return { clock, env };
}

test("a clock that is set ten days ahead takes no result away and stops no job", async (t) => {
  if (!existsSync(FAKETIME)) return t.skip("libfaketime is not installed");
  const { clock, env } = settableClock(t);
  const server = await Server.startIn(env, dataDirectory(t), "--keep-seconds", "24", "--log-level", "warning");
  const before = await server.finished(await server.submit(QUICK, 5));
  const running = await server.submit("stop.iterations=400", 30);
  for (const [set, by] of [["+10d", 1], ["-20d", -1]]) {
    writeFileSync(clock, set);
    const heard = () => server.log.split("the system clock was changed").length - 1;
    for (const already = heard(); heard() === already; ) await sleep(20);
    assert.equal(Math.sign(JSON.parse(server.log.trim().split("\n").at(-1)).by_ms), by);
    assert.equal((await fetch(`${server.url}${before.links.result}`)).status, 200);
  }
  assert.equal((await server.finished(running)).state, "succeeded");
  await server.end("SIGTERM");
});

test("a clock that is two days ahead at the next start takes no result away", async (t) => {
  if (!existsSync(FAKETIME)) return t.skip("libfaketime is not installed");
  const data = dataDirectory(t);
  const { clock, env } = settableClock(t);
  const flags = ["--keep-seconds", "3600", "--log-level", "warning"];
  const first = await Server.startIn(env, data, ...flags);
  const { links } = await first.finished(await first.submit(QUICK, 5));
  await first.end("SIGTERM");
  writeFileSync(clock, "+2d");
  const second = await Server.startIn(env, data, ...flags);
  while (!second.log.includes("the system clock was changed")) await sleep(5); // by the first sweep
  assert.equal((await fetch(`${second.url}${links.result}`)).status, 200);
  await second.end("SIGTERM");
});

// A disk that something else has filled to its last byte: what is there can be read and removed.
import assert from "node:assert/strict";
import { closeSync, openSync, rmSync, statfsSync, writeSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { ENDLESS, QUICK, Server, smallDisk } from "./server.mjs";

const FLAGS = ["--min-free-bytes", "1"];

function fill(disk) {
  const file = openSync(join(disk, "ballast"), "a");
  const block = Buffer.alloc(512);
  try {
    while (writeSync(file, block) > 0);
  } catch (error) {
    assert.equal(error.code, "ENOSPC");
  }
  closeSync(file);
  assert.equal(statfsSync(disk).bavail, 0);
}

const remove = async (server, id) => (await fetch(`${server.url}/v1/jobs/${id}`, { method: "DELETE" })).status;
const resultOf = async (server, id) => (await fetch(`${server.url}/v1/jobs/${id}/result`)).status;

async function finishedJobs(server, count) {
  const ids = [];
  for (let k = 0; k < count; ++k) ids.push((await server.finished(await server.submit(QUICK, 20 + k))).id);
  return ids;
}

test("jobs are removed from a full disk, and cancelled on it", async (t) => {
  const disk = smallDisk(t, 24);
  if (!disk) return t.skip("this user may not mount a file system");
  const server = await Server.start(join(disk, "data"), ...FLAGS);
  const jobs = await finishedJobs(server, 3);
  const running = await server.submit(...ENDLESS);
  const queued = await server.submit(QUICK, 10);
  await server.iterates(running);
  fill(disk);
  assert.equal(await remove(server, queued), 202);
  assert.equal((await server.job(queued)).state, "cancelled");
  assert.equal(await remove(server, running), 202);
  for (const id of jobs) assert.equal(await remove(server, id), 204);
  await server.end("SIGTERM");
});

test("results expire on a full disk", async (t) => {
  const disk = smallDisk(t, 24);
  if (!disk) return t.skip("this user may not mount a file system");
  const server = await Server.start(join(disk, "data"), ...FLAGS, "--keep-seconds", "8");
  const [id] = await finishedJobs(server, 1);
  fill(disk);
  while ((await resultOf(server, id)) === 200) await sleep(50);
  assert.equal(await resultOf(server, id), 410);
  await server.end("SIGTERM");
});

// The end removes the files that SQLite shares memory in: to make them again takes the reserve.
for (const [signal, reserve] of [["SIGKILL", "without"], ["SIGTERM", "with"]]) {
  test(`after ${signal} with a job at work the server starts on a full disk ${reserve} its reserve`, async (t) => {
    const disk = smallDisk(t, 24);
    if (!disk) return t.skip("this user may not mount a file system");
    const data = join(disk, "data");
    const server = await Server.start(data, ...FLAGS, "--drain-seconds", "0");
    const [done] = await finishedJobs(server, 1);
    const working = await server.submit("stop.iterations=300", 60);
    await server.iterates(working);
    await server.end(signal);
    if (reserve === "without") rmSync(join(data, "reserve"));
    fill(disk);
    const again = await Server.start(data, ...FLAGS);
    assert.equal(await resultOf(again, done), 200);
    assert.ok(["queued", "running"].includes((await again.job(working)).state));
    rmSync(join(disk, "ballast"));
    assert.equal((await again.finished(working)).state, "succeeded");
    await again.end("SIGTERM");
  });
}

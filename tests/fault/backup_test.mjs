// `unwrapd backup` while senders send and remove, `restore` and `check`: as an operator runs them.
import assert from "node:assert/strict";
import { execFile, execFileSync, spawnSync } from "node:child_process";
import { readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { promisify } from "node:util";

import { dataDirectory, grid, QUICK, Server } from "./server.mjs";

const run = (...args) => spawnSync(process.env.UNWRAPD, args, { encoding: "utf8", timeout: 60_000 });

const execute = promisify(execFile); // while the senders go on

/** Sends jobs and removes every other one until told to stop. */
async function storm(server, told) {
  for (let k = 0; !told.stop; k++) {
    const headers = { "Content-Type": "model/obj", Prefer: "wait=30", "Cache-Control": "no-cache" };
    const path = `${server.url}/v1/jobs?${QUICK}&resolution=${64 + (k % 64)}`;
    const { id } = await (await fetch(path, { method: "POST", headers, body: grid(5) })).json();
    if (k % 2 === 0) await fetch(`${server.url}/v1/jobs/${id}`, { method: "DELETE" });
  }
}

test("a backup in a storm is whole, and a server on it serves the same", async (t) => {
  const [data, place] = [join(dataDirectory(t), "data"), dataDirectory(t)];
  const server = await Server.start(data, "--workers", "2");
  const kept = await server.finished(await server.submit(QUICK, 7));
  const right = await (await fetch(`${server.url}${kept.links.result}`)).text();
  const told = { stop: false };
  const senders = [storm(server, told), storm(server, told)];
  while ((await (await fetch(`${server.url}/v1/jobs?limit=200`)).json()).jobs.length < 6);
  for (let k = 0; k < 3; k++) {
    const { stdout, stderr } = await execute(process.env.UNWRAPD, ["backup", join(place, `b${k}`), "--data", data]);
    assert.match(stdout, /^backed up: /);
    assert.equal(stderr, "");
  }
  told.stop = true;
  await Promise.all(senders);
  await server.end("SIGKILL");

  const again = join(place, "again");
  assert.equal(run("restore", join(place, "b2"), "--data", again).status, 0);
  const second = await Server.start(again);
  const { jobs } = await (await fetch(`${second.url}/v1/jobs?limit=200`)).json();
  assert.ok(jobs.length > 2);
  for (const { id } of jobs) {
    const job = await second.finished(id);
    assert.equal(job.state, "succeeded", JSON.stringify(job));
    assert.equal((await fetch(`${second.url}${job.links.result}`)).status, 200);
  }
  assert.equal(await (await fetch(`${second.url}${kept.links.result}`)).text(), right);
  assert.equal(run("check", "--data", again).status, 0);
  await second.end("SIGTERM");
});

test("a backup of a server that was killed, and one that is damaged", async (t) => {
  const [data, place] = [join(dataDirectory(t), "data"), dataDirectory(t)];
  const server = await Server.start(data);
  const { id } = await server.finished(await server.submit(QUICK, 5));
  await server.end("SIGKILL");
  const backup = join(place, "b");
  assert.equal(execFileSync(process.env.UNWRAPD, ["backup", backup, "--data", data], { encoding: "utf8" })
    .startsWith("backed up: 1 jobs"), true);
  writeFileSync(join(backup, "blobs", id, "result.obj"), "v 0 0 0\n");
  const refused = run("restore", backup, "--data", join(place, "c"));
  assert.equal(refused.status, 1);
  assert.match(refused.stderr, /not a complete backup: j_\w+\/result\.obj is damaged.*Nothing was restored/);
  const checked = run("check", "--data", backup);
  assert.deepEqual([checked.status, readdirSync(place)], [3, ["b"]]);
  assert.match(run("--help").stdout, /unwrapd backup, restore, check and move/);
});

test("a backup for which there is no room says so, wherever it ends", async (t) => {
  const [data, place] = [dataDirectory(t), dataDirectory(t)];
  const server = await Server.start(data);
  await server.finished(await server.submit(QUICK, 5));
  await server.end("SIGTERM");
  for (const blocks of [20, 60, 100]) { // of 1,024 bytes: the database has more of them
    const words = [`ulimit -f ${blocks}; trap '' XFSZ; exec "$@"`, "sh", process.env.UNWRAPD, "backup", join(place, "b"), "--data", data];
    const told = spawnSync("bash", ["-c", ...words], { encoding: "utf8", timeout: 60_000 });
    assert.equal(told.status, 1);
    assert.match(told.stderr, /disk is full/, `${blocks}: ${told.stderr}`);
    assert.deepEqual(readdirSync(place), []);
  }
});

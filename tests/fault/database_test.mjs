// A server whose rows are in PostgreSQL, while that is killed, restarted and cut off: no job is lost
// and none ends twice. UNWRAPD names the binary.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import test, { after } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { commitProxy, COUNT_ENDS, isInstalled, NOT_INSTALLED, Postgres } from "../postgres/postgres.mjs";
import { dataDirectory, grid, QUICK, Server } from "./server.mjs";

const KILLED_JOBS = 200;
const CUT_JOBS = 100;
const AT_ONCE = 8;
const PROXY_PORT = 5433;
const options = { skip: isInstalled() ? false : NOT_INSTALLED };
const postgres = isInstalled() ? new Postgres({ sync: false }) : undefined;
after(() => postgres?.remove());

async function start(t, data, port = undefined, ...flags) {
  const flagsOfAll = ["--database", postgres.url(port), "--workers", "2", "--isolate=off"];
  const server = await Server.start(data, ...flagsOfAll, ...flags);
  t.after(() => server.process.kill("SIGKILL")); // where it failed
  return server;
}

function forget() {
  postgres.query("DROP SCHEMA public CASCADE; CREATE SCHEMA public");
}

/** Sends a job under a name until it is taken; a refusal must pass, and say when. */
async function submit(server, name, refusals) {
  for (;;) {
    const answer = await fetch(`${server.url}/v1/jobs?preset=chart&${QUICK}`, {
      method: "POST",
      headers: { "Content-Type": "model/obj", "Idempotency-Key": name, "Cache-Control": "no-cache" },
      body: grid(3),
    });
    const body = await answer.json();
    if ([200, 202].includes(answer.status)) return body.id;
    assert.ok([503, 429].includes(answer.status), JSON.stringify(body));
    assert.ok(Number(answer.headers.get("Retry-After")) > 0);
    assert.equal(body.status, answer.status);
    refusals.push(body.code);
    await sleep(100);
  }
}

/** Adds the ids of as many jobs. */
async function submitAll(server, count, ids, refusals) {
  const names = Array.from({ length: count }, (_, k) => `job-${k}`);
  const send = async () => {
    for (let name = names.pop(); name; name = names.pop()) ids.push(await submit(server, name, refusals));
  };
  await Promise.all(Array.from({ length: AT_ONCE }, send));
}

/** Waits until no job waits or runs; returns how often jobs were begun. */
async function allEnd() {
  for (const giveUp = Date.now() + 120_000; ; await sleep(100)) {
    const left = postgres.query("SELECT COUNT(*) FROM jobs WHERE state IN ('queued', 'running')");
    if (left === "0") break;
    assert.ok(Date.now() < giveUp, `${left} jobs never end`);
  }
  return Number(postgres.query("SELECT SUM(attempt) FROM jobs"));
}

function checkEnds(ids, count) {
  assert.equal(new Set(ids).size, count);
  assert.equal(postgres.query("SELECT COUNT(*) FROM jobs WHERE state = 'succeeded'"), String(count));
  assert.equal(postgres.query("SELECT COUNT(*), COUNT(DISTINCT id) FROM ends"), `${count}|${count}`);
}

test("a database that is killed under jobs costs time alone", options, async (t) => {
  const server = await start(t, dataDirectory(t));
  postgres.query(COUNT_ENDS);
  const refusals = [];
  const ids = [];
  const sending = submitAll(server, KILLED_JOBS, ids, refusals);
  for (const [sent, down] of [[KILLED_JOBS / 4, 0], [KILLED_JOBS / 2, 6000]]) {
    while (ids.length < sent) await sleep(5);
    postgres.kill();
    await sleep(down);
    if (down > 0) assert.equal((await fetch(`${server.url}/readyz`)).status, 503);
    postgres.start();
  }
  await sending;
  const begun = await allEnd();
  checkEnds(ids, KILLED_JOBS);
  for (const id of ids.slice(0, 5)) {
    const events = await (await fetch(`${server.url}/v1/jobs/${id}/events`)).text();
    assert.match(events, /succeeded/);
  }
  assert.equal((await fetch(`${server.url}/readyz`)).status, 200);
  assert.deepEqual(await server.end("SIGTERM"), [0, null]);
  assert.ok(refusals.includes("storage_failed"), "while it was away, requests were told so");
  t.diagnostic(`${begun} attempts, ${refusals.length} refusals`);
  forget();
});

test("a COMMIT or its answer that is lost is found out about", options, async (t) => {
  let lost = 0;
  const fate = (count) => {
    if (count % 7 !== 0) return "pass";
    return ++lost % 3 === 0 ? "lose" : "lose answer";
  };
  const proxy = commitProxy(postgres, PROXY_PORT, fate);
  t.after(() => proxy.close());
  const server = await start(t, dataDirectory(t), PROXY_PORT);
  postgres.query(COUNT_ENDS);
  const refusals = [];
  const ids = [];
  await submitAll(server, CUT_JOBS, ids, refusals);
  assert.equal(await allEnd(), CUT_JOBS, "each began once");
  checkEnds(ids, CUT_JOBS);
  assert.deepEqual(refusals.filter((code) => code === "storage_failed"), []);
  assert.ok(lost > CUT_JOBS / 4);
  await server.end("SIGTERM");
  forget();
});

test("one server has a database, its keys are there, and copies are made by its own tools", options, async (t) => {
  const data = dataDirectory(t);
  const run = (...args) =>
    new Promise((done) => {
      const ended = (error, stdout, stderr) => done({ status: error ? error.code : 0, stdout, stderr });
      execFile(process.env.UNWRAPD, args, { timeout: 60_000 }, ended);
    });
  const added = await run("keys", "add", "--data", data, "--database", postgres.url(), "--name", "n");
  const key = added.stdout.trim();
  const server = await start(t, data, undefined, "--require-keys");
  const asked = (headers) => fetch(`${server.url}/v1/jobs`, { headers });
  assert.equal((await asked({})).status, 401);
  assert.equal((await asked({ Authorization: `Bearer ${key}` })).status, 200);
  const serve = (url) => run("--listen", "127.0.0.1:0", "--data", dataDirectory(t), "--database", url);
  const [second, away] = await Promise.all([serve(postgres.url()), serve(postgres.url(9))]);
  assert.equal(second.status, 1);
  assert.match(second.stderr, /another unwrapd uses it/);
  assert.equal(away.status, 1);
  assert.match(away.stderr, /cannot be reached/);
  const backup = await run("backup", "--data", data, "--database", postgres.url(), `${data}.copy`);
  assert.equal(backup.status, 1);
  assert.match(backup.stderr, /pg_dump/);
  await server.end("SIGTERM");
  forget();
});

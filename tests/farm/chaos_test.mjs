// Many jobs on several nodes while nodes are killed and frozen, one is cut off for longer than a lease,
// and PostgreSQL is stopped at once and started: no job is lost, none ends twice, every result has the
// bytes of a node alone, and nothing is left over. FARM_JOBS, FARM_KILLS and FARM_STOPS say how much.
import assert from "node:assert/strict";
import { readFileSync, readdirSync, utimesSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, grid, QUICK, Server } from "../fault/server.mjs";
import { cuttableLink, Farm, LEASE_SECONDS, options, send, sha256Of } from "./nodes.mjs";

const JOBS = Number(process.env.FARM_JOBS ?? 150);
const KILLS = Number(process.env.FARM_KILLS ?? 4);
const STOPS = Number(process.env.FARM_STOPS ?? 1);
const SIZES = [2, 3, 4, 5, 6];
const PATH = `/v1/jobs?preset=chart&${QUICK}`;
const AT_ONCE = 8;
const FLAGS = ["--isolate=off", "--max-queue", "100000"];
const LINK_PORT = 5444;

/** Sends a job under a name until some serving node has taken it. */
async function submit(fronts, k) {
  const headers = { "Idempotency-Key": `job-${k}`, "Cache-Control": "no-cache" };
  for (let round = 0; ; round++) {
    const node = fronts()[(k + round) % 2];
    try {
      const answer = await send(node, PATH, { size: SIZES[k % SIZES.length], headers });
      const body = await answer.json();
      if ([200, 202].includes(answer.status)) return body.id;
      assert.ok([429, 503].includes(answer.status), JSON.stringify(body));
    } catch (error) {
      assert.ok(error instanceof TypeError, error); // the node is gone
    }
    await sleep(100);
  }
}

async function submitAll(fronts) {
  const ids = new Array(JOBS);
  let next = 0;
  const sendSome = async () => {
    for (let k = next++; k < JOBS; k = next++) ids[k] = await submit(fronts, k);
  };
  await Promise.all(Array.from({ length: AT_ONCE }, sendSome));
  return ids;
}

async function digestsOfANodeAlone(t) {
  const alone = await Server.start(dataDirectory(t));
  const digests = [];
  for (const size of SIZES) digests.push(await sha256Of(await send(alone, `/v1/unwrap?preset=chart&${QUICK}`, { size })));
  await alone.end("SIGTERM");
  return digests;
}

function age(folder) {
  const old = Date.now() / 1000 - 7200;
  for (const entry of readdirSync(folder, { withFileTypes: true })) {
    if (entry.isDirectory()) age(join(folder, entry.name));
    utimesSync(join(folder, entry.name), old, old);
  }
}

test(`${JOBS} jobs outlive ${KILLS} kills, ${STOPS} stops of the database, a cut and a freeze`, options, async (t) => {
  const expected = await digestsOfANodeAlone(t);
  const farm = new Farm(t);
  const link = cuttableLink(farm.postgres, LINK_PORT);
  t.after(link.close);
  const names = ["front-1", "front-2", "one", "two", "three", "cut"];
  const starts = (name) => {
    const workers = name.startsWith("front") ? 0 : 1;
    return name === "cut" ? farm.startBy(link.url, name, workers, ...FLAGS) : farm.start(name, workers, ...FLAGS);
  };
  await Promise.all(names.map(starts)); // at one moment, on an empty database
  farm.countEnds();
  const fronts = () => [farm.nodes.get("front-1"), farm.nodes.get("front-2")];

  const submitting = submitAll(fronts);
  const pause = () => sleep(Math.max(300, JOBS));
  const harm = async () => {
    for (let k = 0; k < Math.max(KILLS, STOPS); k++) {
      await pause();
      if (k < KILLS) {
        const name = names[(k * 5 + 2) % (names.length - 1)];
        await farm.nodes.get(name).end("SIGKILL");
        await starts(name);
      }
      if (k === 0) link.cut();
      if (k === 1) farm.nodes.get("three").process.kill("SIGSTOP");
      if (k >= KILLS - STOPS) {
        farm.postgres.kill();
        await sleep(500);
        farm.postgres.start();
      }
    }
    await sleep(1000 * (LEASE_SECONDS + 1));
    link.mend();
    farm.nodes.get("three").process.kill("SIGCONT");
  };
  const [ids] = await Promise.all([submitting, harm()]);
  await farm.allEnd(60 + JOBS);

  assert.equal(new Set(ids).size, JOBS);
  assert.equal(farm.query("SELECT COUNT(*) FROM jobs WHERE state = 'succeeded'"), String(JOBS));
  assert.equal(farm.query("SELECT COUNT(*), COUNT(DISTINCT id) FROM ends"), `${JOBS}|${JOBS}`);
  assert.equal(farm.query("SELECT COALESCE(SUM(waiting + running), 0) FROM shares"), "0");
  for (const [k, id] of ids.entries()) {
    const answer = await fetch(`${fronts()[k % 2].url}/v1/jobs/${id}/result`);
    assert.equal(answer.status, 200, id);
    assert.equal(await sha256Of(answer), expected[k % SIZES.length], id);
  }
  t.diagnostic(`${farm.query("SELECT COUNT(*) FROM jobs WHERE attempt > 1")} jobs were begun more than once`);

  await Promise.all([...farm.nodes.values()].map((node) => node.end("SIGTERM")));
  age(farm.shared);
  const last = await farm.start("front-1", 0);
  for (const giveUp = Date.now() + 20_000; farm.folders("incoming").length > 0; await sleep(50))
    assert.ok(Date.now() < giveUp, farm.folders("incoming").join());
  assert.deepEqual(farm.folders("blobs"), [...ids].sort());

  const flip = (file) => {
    const path = join(farm.shared, "blobs", ids[0], file);
    const bytes = readFileSync(path);
    bytes[bytes.length >> 1] ^= 1;
    writeFileSync(path, bytes);
  };
  flip(readdirSync(join(farm.shared, "blobs", ids[0])).find((file) => file.startsWith("result.")));
  const path = `${last.url}/v1/jobs/${ids[0]}`;
  assert.equal(await sha256Of(await fetch(`${path}/result`)), expected[0], "made again, as it is damaged");
  flip("report.json");
  assert.equal((await (await fetch(`${path}/report`)).json()).code, "storage_corrupt");
});

// Many jobs on hosts with links of their own to the database and to the files: nodes are killed and frozen,
// links lose all packets for longer than a session lives, and PostgreSQL is stopped at once. No job is lost,
// none ends twice, every result has the bytes of a node alone. FARM_JOBS, FARM_KILLS and FARM_STOPS say how
// much; with FARM_JOBS the files are in a bucket.
import assert from "node:assert/strict";
import test from "node:test";
import { fileURLToPath } from "node:url";
import { setTimeout as sleep } from "node:timers/promises";

import { isInstalled as hasBucket, Radosgw } from "../bucket/radosgw.mjs";
import { Postgres } from "../postgres/postgres.mjs";
import { canMakeHosts, Host, HUB, isApart, makeNetwork, NO_NAMESPACES, runApart } from "./hosts.mjs";
import { assertAllDone, digestsOfANodeAlone, FLAGS, submitAll } from "./load.mjs";
import { Farm, LEASE_SECONDS, options, send } from "./nodes.mjs";

const JOBS = Number(process.env.FARM_JOBS ?? 40);
const KILLS = Number(process.env.FARM_KILLS ?? 3);
const STOPS = Number(process.env.FARM_STOPS ?? 1);
const NAMES = ["front-1", "front-2", "one", "two", "three", "four"];
const SESSION_SECONDS = 10; // until a side gives up a session whose packets are lost
const TITLE = `${JOBS} jobs on hosts outlive ${KILLS} kills, ${STOPS} stops of the database, cuts and a freeze`;

async function filesIn(t, farm) {
  if (!process.env.FARM_JOBS || !hasBucket()) return () => farm.folders("blobs");
  const store = await Radosgw.start(HUB);
  t.after(() => store.remove());
  store.s3("PUT", "/jobs");
  Object.assign(process.env, store.environment());
  farm.blobs = ["--blobs", "s3://jobs/farm", "--s3-endpoint", store.endpoint];
  return () => {
    const jobs = new Set();
    for (let more = "", last; ; more = `&start-after=${last}`) {
      const page = String(store.s3("GET", `/jobs?list-type=2&prefix=farm%2F${more}`));
      const keys = [...page.matchAll(/<Key>(.*?)<\/Key>/g)].map(([, key]) => key);
      keys.forEach((key) => jobs.add(key.split("/")[1]));
      if (!page.includes("<IsTruncated>true")) return [...jobs].filter((name) => name.startsWith("j_")).sort();
      last = encodeURIComponent(keys.at(-1));
    }
  };
}

async function outliveHarm(t) {
  makeNetwork();
  const expected = await digestsOfANodeAlone(t);
  const farm = new Farm(t, new Postgres({ sync: false, settings: { listen_addresses: HUB, max_connections: 100 } }));
  farm.url = `postgres://postgres@${HUB}/postgres`;
  const jobsWithFiles = await filesIn(t, farm);
  const hosts = new Map();
  for (const name of NAMES) hosts.set(name, await Host.start(t));
  farm.program = (name) => hosts.get(name).inside(process.env.UNWRAPD);
  const starts = (name) =>
    farm.start(name, name.startsWith("front") ? 0 : 1, "--listen", `${hosts.get(name).address}:0`, "--insecure", ...FLAGS);
  await Promise.all(NAMES.map(starts));
  farm.countEnds();
  const fronts = () => [farm.nodes.get("front-1"), farm.nodes.get("front-2")];

  const body = { size: 60, headers: { "Cache-Control": "no-cache" } };
  const { id } = await (await send(fronts()[0], "/v1/jobs?preset=paper&stop.iterations=4000", body)).json();
  await fronts()[0].iterates(id);
  const cut = farm.nodeOf(id).name; // its host is the first to be cut off
  const others = NAMES.filter((name) => name !== cut && name !== "front-2");

  const ids = new Array(JOBS);
  const submitting = submitAll(fronts, JOBS, ids);
  const cutFor = async (name, seconds) => {
    hosts.get(name).cut();
    await sleep(1000 * seconds);
    hosts.get(name).mend();
  };
  const cuts = async () => {
    await Promise.all([cutFor(cut, SESSION_SECONDS + 2), cutFor("front-2", LEASE_SECONDS + 1)]);
    if (process.env.FARM_JOBS) await cutFor(others.at(-1), SESSION_SECONDS + 2);
  };
  const harm = async () => {
    for (let k = 0; k < Math.max(KILLS, STOPS); k++) {
      await sleep(Math.max(300, JOBS));
      const name = others[k % others.length];
      if (k < KILLS) {
        await farm.nodes.get(name).end("SIGKILL");
        await starts(name).catch(() => sleep(2000).then(() => starts(name))); // its host is cut off
      }
      if (k === 1) farm.nodes.get(others[1]).process.kill("SIGSTOP");
      if (k >= KILLS - STOPS) {
        farm.postgres.kill();
        await sleep(500);
        farm.postgres.start();
      }
    }
    await sleep(1000 * (LEASE_SECONDS + 1));
    farm.nodes.get(others[1]).process.kill("SIGCONT");
  };
  await Promise.all([submitting, cuts(), harm()]);
  await farm.allEnd(60 + JOBS);

  await assertAllDone(farm, fronts, ids, expected, 1);
  assert.equal(farm.query(`SELECT attempt > 1 FROM jobs WHERE id = '${id}'`), "t", "another did the job of the host cut off");
  const stored = new Set(jobsWithFiles());
  for (const job of [id, ...ids]) assert.ok(stored.delete(job), `files of ${job}`);
  t.diagnostic(`${stored.size} folders are left for the sweep, of requests whose node was killed`);
  t.diagnostic(`${farm.query("SELECT COUNT(*) FROM jobs WHERE attempt > 1")} jobs were begun more than once`);
}

if (isApart()) {
  test(TITLE, outliveHarm);
} else {
  const skip = options.skip || (canMakeHosts() ? false : NO_NAMESPACES);
  test(`apart: ${TITLE}`, { skip }, async (t) => {
    const { code, text } = await runApart(fileURLToPath(import.meta.url), (line) => t.diagnostic(line));
    assert.equal(code, 0, text);
  });
}

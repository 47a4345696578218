// Many jobs on several nodes while nodes are killed and frozen, one is cut off for longer than a lease,
// and PostgreSQL is stopped at once and started: no job is lost, none ends twice, every result has the
// bytes of a node alone, and nothing is left over. FARM_JOBS, FARM_KILLS and FARM_STOPS say how much.
import assert from "node:assert/strict";
import { readFileSync, readdirSync, utimesSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { assertAllDone, digestsOfANodeAlone, FLAGS, submitAll } from "./load.mjs";
import { cuttableLink, Farm, LEASE_SECONDS, options, sha256Of } from "./nodes.mjs";

const JOBS = Number(process.env.FARM_JOBS ?? 150);
const KILLS = Number(process.env.FARM_KILLS ?? 4);
const STOPS = Number(process.env.FARM_STOPS ?? 1);
const LINK_PORT = 5444;

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

  const ids = new Array(JOBS);
  const submitting = submitAll(fronts, JOBS, ids);
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
  await Promise.all([submitting, harm()]);
  await farm.allEnd(60 + JOBS);

  await assertAllDone(farm, fronts, ids, expected);
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

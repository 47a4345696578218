// From one version to the next while both run: nodes of the new version start beside those of the old one
// and migrate the tables, jobs go on through both, and the old nodes leave one by one. OLD_UNWRAPD names the
// old version's binary. No job is lost, none ends twice, every result has the bytes of a node alone.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { assertAllDone, digestsOfANodeAlone, FLAGS, submitAll } from "./load.mjs";
import { Farm, LEASE_SECONDS, options, send, watch } from "./nodes.mjs";

const OLD = process.env.OLD_UNWRAPD ?? "";
const NO_OLD = "OLD_UNWRAPD names no binary of the version before";
const JOBS = Number(process.env.FARM_JOBS ?? 200);

test(`${JOBS} jobs while a farm gets a new version`, { skip: options.skip || (!existsSync(OLD) && NO_OLD) }, async (t) => {
  const expected = await digestsOfANodeAlone(t);
  const farm = new Farm(t);
  farm.program = (name) => [name.startsWith("old") ? OLD : process.env.UNWRAPD];
  const start = (name) => farm.start(name, name.includes("front") ? 0 : 1, "--threads", "1", ...FLAGS);
  const schema = () => Number(farm.query("SELECT version FROM schema_version"));
  for (const name of ["old-front-1", "old-front-2", "old-one", "old-two"]) await start(name);
  farm.countEnds();
  let names = ["old-front-1", "old-front-2"];
  const fronts = () => names.map((name) => farm.nodes.get(name));
  const before = schema();
  const long = await (await send(fronts()[0], "/v1/jobs?preset=paper&stop.iterations=3000", { size: 60 })).json();
  await fronts()[0].iterates(long.id);

  const ids = new Array(JOBS);
  let sent = 0;
  const ready = async (k) => {
    while (k >= sent) await sleep(10);
  };
  const submitting = submitAll(fronts, JOBS, ids, { ready });
  /** Does something while so many of the jobs are sent. */
  const meanwhile = async (share, act) => {
    sent = JOBS * share;
    await act();
    while (ids.filter(Boolean).length < sent) await sleep(10);
  };
  const leave = async (name) => assert.deepEqual(await farm.nodes.get(name).end("SIGTERM"), [0, null], name);

  await meanwhile(0.2, () => sleep(100));
  await meanwhile(0.4, () => start("new-front-1"));
  assert.ok(schema() >= before);
  t.diagnostic(`schema ${before} became ${schema()}`);
  names = ["old-front-1", "new-front-1", "old-front-2"];
  const events = watch(farm.nodes.get("new-front-1"), long.id);
  await meanwhile(0.6, async () => {
    await start("new-one");
    await sleep(1000 * (LEASE_SECONDS + 1)); // both versions look at each other's leases
  });
  names = ["new-front-1", "old-front-2"];
  await meanwhile(0.8, async () => {
    await leave("old-front-1");
    await leave("old-one");
    await start("new-front-2");
  });
  if (schema() > before) await assert.rejects(start("old-one"), /job store is of another version/);
  names = ["new-front-1", "new-front-2"];
  await meanwhile(1, async () => {
    await leave("old-front-2");
    await start("new-two");
    await leave("old-two");
  });
  await submitting;
  assert.equal((await events).names.at(-1), "succeeded");
  await farm.allEnd(60 + JOBS);
  await assertAllDone(farm, fronts, ids, expected, 1);
  const again = farm.query("SELECT COUNT(*) FROM jobs WHERE attempt > 1");
  const nodes = farm.query("SELECT COUNT(DISTINCT node) FROM jobs");
  t.diagnostic(`${nodes} nodes ended jobs; ${again} jobs were begun more than once; ${farm.query("SELECT SUM(crashes) FROM jobs")} deaths`);
});

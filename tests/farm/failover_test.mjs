// The primary of the database is lost for good while jobs are sent and run, and its synchronous standby
// takes its place: no accepted job is lost, none ends twice, every result has the bytes of a node alone.
// While there is no primary, requests are told to come back, and nothing else. Events and rates are in
// tables that no standby has: their readers go on. FARM_JOBS says how many jobs.
import assert from "node:assert/strict";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { Postgres } from "../postgres/postgres.mjs";
import { assertAllDone, digestsOfANodeAlone, FLAGS, submitAll } from "./load.mjs";
import { Farm, options, send, watch } from "./nodes.mjs";

const JOBS = Number(process.env.FARM_JOBS ?? 90);
const PATIENCE_MS = 5000; // of a call whose session was lost
const GAP_MS = PATIENCE_MS + 1500;
const RATE = 12;
const SYNCHRONOUS = { synchronous_standby_names: "standby" };

/** A farm whose nodes know the primary and the standby, in this order. */
async function farmWithStandby(t) {
  const primary = new Postgres({ sync: false, settings: SYNCHRONOUS });
  const farm = new Farm(t, primary);
  const standby = new Postgres({ sync: false, from: primary });
  t.after(() => standby.remove());
  const isSynchronous = () => primary.query("SELECT sync_state FROM pg_stat_replication") === "sync";
  for (const giveUp = Date.now() + 20_000; !isSynchronous(); await sleep(20)) assert.ok(Date.now() < giveUp);
  farm.url = `postgres://postgres@/postgres?host=${[primary, standby].map(({ folder }) => encodeURIComponent(folder))}`;
  return { farm, primary, standby };
}

function assertToldToComeBack(answer, body) {
  assert.equal(answer.status, 503, JSON.stringify(body));
  assert.equal(body.code, "storage_failed", JSON.stringify(body));
  assert.ok(Number(answer.headers.get("Retry-After")) > 0);
}

/** A client that counts what it was refused. */
function countingClient() {
  const client = {
    refusals: 0,
    refused(answer, body) {
      assertToldToComeBack(answer, body);
      client.refusals++;
    },
    failed: (error) => assert.fail(error),
  };
  return client;
}

test(`${JOBS} jobs outlive the loss of the primary`, options, async (t) => {
  const expected = await digestsOfANodeAlone(t);
  const { farm, primary, standby } = await farmWithStandby(t);
  const key = farm.addKey("--name", "slow", "--scopes", "read", "--requests-per-minute", String(RATE));
  const names = ["front-1", "front-2", "one", "two", "three"];
  const start = (name) => farm.start(name, name.startsWith("front") ? 0 : 1, "--threads", "1", ...FLAGS);
  await Promise.all(names.map(start));
  const guarded = await farm.start("guarded", 0, "--require-keys", ...FLAGS);
  farm.countEnds();
  const fronts = () => [farm.nodes.get("front-1"), farm.nodes.get("front-2")];
  const [front, other] = fronts();
  const free = farm.addKey("--name", "free", "--scopes", "read");
  const jobsWith = (own) => fetch(`${guarded.url}/v1/jobs`, { headers: { Authorization: `Bearer ${own}` } });
  const withKey = () => jobsWith(key);

  const begin = async (iterations, size) => {
    const { id } = await (await send(front, `/v1/jobs?preset=paper&stop.iterations=${iterations}`, { size })).json();
    await front.iterates(id);
    return { id, events: watch(other, id) };
  };
  const endless = await begin(10000, 160);
  const ending = await begin(2000, 60);
  assert.equal((await withKey()).status, 200);

  const ids = new Array(JOBS);
  const client = countingClient();
  const submitting = submitAll(fronts, JOBS, ids, client);
  while (ids.filter(Boolean).length < JOBS / 3) await sleep(5);
  const accepted = ids.filter(Boolean);
  primary.loseMachine();
  const until = Date.now() + GAP_MS;
  t.diagnostic(`${accepted.length} jobs were accepted when the primary was lost`);

  const known = (node) => () => fetch(`${node.url}/v1/jobs/${accepted[0]}`);
  await t.test("while there is none, requests are told to come back", async () => {
    const told = async (request) => {
      const codes = new Set();
      for (; Date.now() < until; await sleep(50)) {
        const answer = await request();
        if (answer.status !== 200) assertToldToComeBack(answer, await answer.json());
        codes.add(answer.status);
      }
      assert.ok(codes.has(503));
    };
    await Promise.all([known(front), known(other), withKey].map(told));
  });
  await farm.nodes.get("one").end("SIGKILL");
  assert.throws(() => standby.query("SELECT * FROM events"), /unlogged relations during recovery/);
  standby.promote();
  farm.postgres = standby;
  await start("one");
  await submitting;
  assert.ok(client.refusals > 0);

  await t.test("readers of events get the last one of each job", async () => {
    const events = await ending.events;
    assert.equal(events.names.at(-1), "succeeded", events.names.join());
    assert.deepEqual(events.ids, [...events.ids].sort((a, b) => a - b));
    const cancel = async () => (await fetch(`${front.url}/v1/jobs/${endless.id}`, { method: "DELETE" })).status;
    for (let status = await cancel(); status !== 202; status = await cancel()) assert.equal(status, 503);
    assert.equal((await endless.events).names.at(-1), "cancelled");
  });

  await t.test("the rate of a key is enforced, from a full minute", async () => {
    // A node may look for the new primary a little longer, and its answers of 503 count for their key.
    for (const giveUp = Date.now() + 20_000; (await jobsWith(free)).status === 503; await sleep(50))
      assert.ok(Date.now() < giveUp);
    const codes = [];
    let last;
    for (let k = 0; k < RATE + 10; k++) codes.push((last = await withKey()).status);
    const told = `${codes}; the last answer: ${await last.text()}`;
    assert.ok(codes.every((code) => [200, 429].includes(code)), told);
    assert.ok(codes.includes(429) && codes.filter((code) => code === 200).length >= RATE, told);
  });

  await farm.allEnd(60 + JOBS);
  await assertAllDone(farm, fronts, ids, expected, 1);
  const again = farm.query("SELECT COUNT(*) FROM jobs WHERE attempt > 1");
  t.diagnostic(`${client.refusals} answers of 503; ${again} jobs were begun more than once`);
});

// Several real nodes on one real PostgreSQL and one directory: any node answers for any job, what is
// promised once holds for all of them together, and a node that dies takes no job with it.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import { once } from "node:events";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, ENDLESS, grid, QUICK, Server } from "../fault/server.mjs";
import { Farm, LEASE_SECONDS, options, send, sha256Of, watch } from "./nodes.mjs";

const [ENDLESS_QUERY, ENDLESS_SIZE] = ENDLESS;
const SLOW = `/v1/jobs?preset=paper&${ENDLESS_QUERY}`;
const MADE_ONCE = `/v1/jobs?preset=chart&${QUICK}`;

async function cancel(node, id, headers = {}) {
  const answer = await fetch(`${node.url}/v1/jobs/${id}`, { method: "DELETE", headers });
  assert.equal(answer.status, 202);
}

test("any node answers for any job", options, async (t) => {
  const farm = new Farm(t);
  const [front, worker, other] = [await farm.start("front", 0), await farm.start("worker", 1), await farm.start("other", 0)];

  await t.test("sent at one, watched and fetched at others: the bytes of a node alone", async (t) => {
    const alone = await Server.start(dataDirectory(t));
    const job = await (await send(front, MADE_ONCE)).json();
    const events = await watch(other, job.id);
    assert.deepEqual(events.names.filter((name) => ["queued", "started", "succeeded", "gap"].includes(name)), [
      "queued", "started", "succeeded"]);
    assert.deepEqual(events.ids, [...new Set(events.ids)].sort((a, b) => a - b));
    const expected = await sha256Of(await send(alone, `/v1/unwrap?preset=chart&${QUICK}`));
    for (const node of [front, worker, other]) {
      assert.equal((await node.job(job.id)).state, "succeeded");
      assert.equal(await sha256Of(await fetch(`${node.url}/v1/jobs/${job.id}/result`)), expected);
      assert.equal((await fetch(`${node.url}/v1/jobs/${job.id}/layout.png?size=64`)).status, 200);
    }
    assert.equal(await sha256Of(await send(other, `/v1/unwrap?preset=chart&${QUICK}`)), expected);
    const again = await watch(worker, job.id, Date.now(), { "Last-Event-ID": String(events.ids.at(-2)) });
    assert.deepEqual(again.ids, events.ids.slice(-1));
  });

  await t.test("a running job tells its progress, and is cancelled, at another", async () => {
    const { id } = await (await send(front, SLOW, { size: ENDLESS_SIZE })).json();
    const job = await other.iterates(id);
    assert.equal(job.progress.stage, "solve");
    const watching = watch(front, id);
    await cancel(other, id);
    assert.equal((await watching).names.at(-1), "cancelled");
    assert.equal((await worker.finished(id)).state, "cancelled");
  });

  await t.test("a waiting job is cancelled at another", async () => {
    const running = await (await send(front, SLOW, { size: ENDLESS_SIZE })).json();
    await front.iterates(running.id);
    const waiting = await (await send(front, MADE_ONCE, { size: 4 })).json();
    const watching = watch(front, waiting.id);
    await cancel(other, waiting.id);
    assert.deepEqual((await watching).names, ["queued", "cancelled"]);
    await cancel(worker, running.id);
    await farm.allEnd();
  });

  await t.test("a mesh and a signed link of one are good at another", async () => {
    const mesh = Buffer.from(grid(5));
    const sha256 = await sha256Of(new Response(mesh));
    assert.equal((await send(front, `/v1/meshes/${sha256}`, { method: "PUT", body: mesh })).status, 201);
    const options = { body: '{"preset": "chart"}', headers: { "Content-Type": "application/json" } };
    const job = await (await send(other, `/v1/meshes/${sha256}/jobs`, options)).json();
    await front.finished(job.id);
    const link = await (await fetch(`${front.url}/v1/jobs/${job.id}/link?file=result`)).json();
    assert.equal((await fetch(other.url + link.url)).status, 200);
  });

  await t.test("a job that is removed at one is gone at all", async () => {
    const { id } = await (await send(front, MADE_ONCE, { size: 6 })).json();
    await other.finished(id);
    assert.equal((await fetch(`${other.url}/v1/jobs/${id}`, { method: "DELETE" })).status, 204);
    for (const node of [front, worker]) assert.equal((await fetch(`${node.url}/v1/jobs/${id}`)).status, 404);
  });
});

test("a node that dies, freezes or leaves", options, async (t) => {
  const farm = new Farm(t);
  const front = await farm.start("front", 0);
  await farm.start("one", 1);
  farm.countEnds();
  let count = 0;
  const start = async (size = 60) => {
    const body = `${grid(size)}# ${++count}\n`; // another question each time
    const { id } = await (await send(front, "/v1/jobs?preset=paper&stop.iterations=10000", { body })).json();
    await front.iterates(id);
    return id;
  };

  await t.test("a node that starts beside a working one takes nothing from it", async () => {
    const id = await start(ENDLESS_SIZE);
    await farm.start("two", 1);
    await sleep(1000 * (LEASE_SECONDS + 1));
    assert.equal(farm.query(`SELECT attempt, crashes FROM jobs WHERE id = '${id}'`), "1|0");
    await cancel(front, id);
    await farm.allEnd();
  });

  await t.test("killed: another does its job after the lease", async () => {
    const id = await start();
    const killed = farm.nodeOf(id);
    const watching = watch(front, id);
    await killed.end("SIGKILL");
    const events = await watching;
    assert.equal(events.names.at(-1), "succeeded");
    assert.equal(events.names.filter((name) => name === "started").length, 2);
    assert.equal(farm.query(`SELECT attempt, crashes FROM jobs WHERE id = '${id}'`), "2|1");
    await farm.start(killed.name, 1);
  });

  await t.test("killed and started again: its job is taken up at once", async () => {
    const id = await start();
    const killed = farm.nodeOf(id);
    await killed.end("SIGKILL");
    await farm.start(killed.name, 1);
    assert.notEqual(farm.query(`SELECT state, attempt FROM jobs WHERE id = '${id}'`), "running|1");
    assert.equal((await front.finished(id)).state, "succeeded");
  });

  await t.test("frozen past its lease and thawed: what it does counts for nothing", async () => {
    const id = await start();
    const frozen = farm.nodeOf(id);
    frozen.process.kill("SIGSTOP");
    const job = await front.finished(id);
    assert.equal(job.attempt, 2);
    const before = await sha256Of(await fetch(`${front.url}/v1/jobs/${id}/report`));
    frozen.process.kill("SIGCONT");
    await sleep(3000);
    assert.equal(await sha256Of(await fetch(`${front.url}/v1/jobs/${id}/report`)), before);
    assert.equal(await sha256Of(await fetch(`${frozen.url}/v1/jobs/${id}/report`)), before);
  });

  await t.test("told to end: its job waits for another", async () => {
    const id = await start();
    const leaving = farm.nodeOf(id);
    leaving.process.kill("SIGTERM");
    leaving.process.kill("SIGTERM"); // without patience
    assert.equal((await front.finished(id)).state, "succeeded");
    assert.equal(farm.query(`SELECT crashes FROM jobs WHERE id = '${id}'`), "0");
    assert.deepEqual(await leaving.exited, [0, null]);
  });

  await t.test("no job has ended twice, and nothing is left over", async () => {
    await farm.allEnd();
    assert.equal(farm.query("SELECT COUNT(*) - COUNT(DISTINCT id) FROM ends"), "0");
    const kept = farm.query("SELECT id FROM jobs WHERE state = 'succeeded'").split("\n").sort();
    assert.deepEqual(farm.folders("blobs"), kept);
  });
});

test("what is promised once holds for all nodes together", options, async (t) => {
  const farm = new Farm(t);
  const fronts = [await farm.start("a", 0, "--require-keys"), await farm.start("b", 0, "--require-keys")];
  const all = farm.addKey("--name", "all", "--scopes", "admin");
  const as = (key, headers = {}) => ({ Authorization: `Bearer ${key}`, ...headers });
  const race = (count, request) => Promise.all(Array.from({ length: count }, (_, k) => request(fronts[k % 2], k)));

  await t.test("a request of one name makes one job", async () => {
    for (let round = 0; round < 10; round++) {
      const answers = await race(6, (node) =>
        send(node, MADE_ONCE, { headers: as(all, { "Idempotency-Key": `order-${round}` }) }));
      const ids = await Promise.all(answers.map(async (answer) => (await answer.json()).id));
      assert.equal(new Set(ids).size, 1, JSON.stringify(ids));
    }
    assert.equal(farm.query("SELECT COUNT(*) FROM jobs"), "10");
    assert.equal(farm.folders("blobs").length, 10);
  });

  await t.test("a job whose id is chosen is made once", async () => {
    for (let round = 0; round < 10; round++) {
      const id = `j_${String(round).padStart(32, "a")}`;
      const answers = await race(6, (node) =>
        send(node, MADE_ONCE.replace("/jobs?", `/jobs/${id}?`), { method: "PUT", headers: as(all) }));
      const told = await Promise.all(answers.map(async (answer) => [answer.status, (await answer.json()).id]));
      for (const [status, known] of told) assert.ok(status === 503 || (status === 202 && known === id), `${status}`);
      assert.ok(told.some(([status]) => status === 202));
    }
  });

  await t.test("a quota of jobs is exact", async () => {
    const key = farm.addKey("--name", "few", "--scopes", "submit,read", "--max-jobs", "5");
    const answers = await race(30, (node, k) =>
      send(node, MADE_ONCE, { body: `${grid(3)}# ${k}\n`, headers: as(key) }));
    const codes = answers.map((answer) => answer.status);
    assert.equal(codes.filter((code) => code === 202).length, 5, String(codes));
    assert.ok(codes.every((code) => [202, 429].includes(code)), String(codes));
  });

  await t.test("the rate of a key is exact", async () => {
    const key = farm.addKey("--name", "slow", "--scopes", "read", "--requests-per-minute", "12");
    const began = Date.now();
    const answers = await race(60, (node) => fetch(`${node.url}/v1/jobs`, { headers: as(key) }));
    const more = Math.floor((Date.now() - began) / 5000); // came while they ran
    const allowed = answers.filter((answer) => answer.status === 200).length;
    assert.ok(allowed >= 12 && allowed <= 12 + more, `${allowed} of 12`);
    const waits = answers.filter((answer) => answer.status === 429).map((answer) => Number(answer.headers.get("Retry-After")));
    assert.ok(waits.length > 40 && waits.every((seconds) => seconds >= 1 && seconds <= 5), String(waits));
  });

  await t.test("an upload ticket is good for one job", async () => {
    const made = await send(fronts[0], "/v1/tickets", { body: "", headers: as(all, { "Content-Type": "application/json" }) });
    const { urls } = await made.json();
    const answers = await race(10, (node, k) =>
      fetch(new URL(urls[0], node.url), {
        method: "POST", headers: { "Content-Type": "model/obj" }, body: `${grid(3)}# ${k}\n` }));
    assert.equal(answers.filter((answer) => answer.status === 202).length, 1, String(answers.map((answer) => answer.status)));
    const same = await send(fronts[0], "/v1/tickets", { body: "", headers: as(all, { "Content-Type": "application/json" }) });
    const [url] = (await same.json()).urls;
    const told = await race(10, async (node) => (await send(node, url, {})).json());
    assert.equal(new Set(told.map(({ id }) => id)).size, 1, JSON.stringify(told[0]));
  });

  await t.test("a key with many jobs keeps another waiting for one job at most", async () => {
    const [greedy, modest] = ["greedy", "modest"].map((name) => farm.addKey("--name", name, "--scopes", "submit,read"));
    const sent = (k) => ({ body: `${grid(2)}# ${k}\n` });
    const many = [];
    for (let k = 0; k < 100; k++)
      many.push(await (await send(fronts[k % 2], MADE_ONCE, { ...sent(k), headers: as(greedy) })).json());
    await farm.start("worker", 1);
    const { id } = await (await send(fronts[0], MADE_ONCE, { ...sent("modest"), headers: as(modest) })).json();
    const accepted = Date.now();
    await farm.allEnd();
    const between = farm.query(`SELECT COUNT(*) FROM jobs WHERE started_ms > ${accepted}
      AND owner = (SELECT owner FROM jobs WHERE id = '${many[0].id}')
      AND started_ms < (SELECT started_ms FROM jobs WHERE id = '${id}')`);
    assert.ok(Number(between) <= 1, `${between} jobs came first`);
  });
});

test("a webhook is called once though all nodes look for calls that are due", options, async (t) => {
  const farm = new Farm(t);
  const calls = [];
  const receiver = createServer((request, response) => {
    calls.push(request.headers["webhook-id"]);
    setTimeout(() => response.end(), 300);
  });
  receiver.listen(0, "127.0.0.1");
  await once(receiver, "listening");
  t.after(() => receiver.close());
  const flags = ["--webhook-hosts", "127.0.0.1", "--webhook-private"];
  const nodes = [];
  for (const name of ["a", "b", "c"]) nodes.push(await farm.start(name, 1, ...flags));
  const hook = `http://127.0.0.1:${receiver.address().port}/`;
  const forbidden = await farm.start("may call nobody", 1);
  const ids = [];
  for (let k = 0; k < 12; k++) {
    const asked = { body: `${grid(2)}# ${k}\n`, headers: { "Unwrapd-Webhook": hook } };
    const answer = await send(nodes[k % 3], MADE_ONCE, asked);
    ids.push((await answer.json()).id);
  }
  await farm.allEnd();
  for (const giveUp = Date.now() + 20_000; farm.query("SELECT COUNT(*) FROM deliveries") !== "0"; await sleep(100))
    assert.ok(Date.now() < giveUp);
  assert.deepEqual([...calls].sort(), [...ids].sort());
  assert.doesNotMatch(forbidden.log, /not reached/);
});

test("without hints all is found by looking", options, async (t) => {
  const farm = new Farm(t);
  farm.query("CREATE ROLE quiet LOGIN; ALTER SCHEMA public OWNER TO quiet; GRANT pg_signal_backend, pg_read_all_stats TO quiet");
  farm.query("REVOKE EXECUTE ON FUNCTION pg_notify(text, text) FROM PUBLIC");
  farm.url = farm.url.replace("postgres@", "quiet@");
  const [front, worker] = [await farm.start("front", 0), await farm.start("worker", 1)];
  for (let k = 0; k < 3; k++) {
    const { id } = await (await send(front, MADE_ONCE, { body: `${grid(3)}# ${k}\n` })).json();
    assert.equal((await watch(front, id)).names.at(-1), "succeeded");
  }
  const { id } = await (await send(front, SLOW, { size: ENDLESS_SIZE })).json();
  await front.iterates(id);
  await cancel(front, id);
  assert.equal((await front.finished(id)).state, "cancelled");
  assert.match(worker.log + front.log, /get no hints/);
});

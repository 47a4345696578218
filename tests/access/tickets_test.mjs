// A browser without an API key, against a server that requires keys: signed links to the events and
// the state of a job, and upload tickets, each of which takes one job for the key of its holder.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import test from "node:test";

import { dataDirectory, grid, QUICK, Server } from "../fault/server.mjs";

const keys = (data, ...args) =>
  execFileSync(process.env.UNWRAPD, ["keys", ...args, "--data", data], { stdio: ["ignore", "pipe", "ignore"] }).toString();

/** The header fields of the holder of a new key. */
function holder(data, name, ...flags) {
  return { Authorization: `Bearer ${keys(data, "add", "--name", name, ...flags).trim()}` };
}

async function refused(answer, status, code) {
  const problem = await answer.json();
  assert.deepEqual([answer.status, problem.code], [status, code], problem.detail);
}

async function json(answer, status) {
  const body = await answer.json();
  assert.equal(answer.status, status, JSON.stringify(body));
  return body;
}

const kObj = { "Content-Type": "model/obj" };
const size = grid(4).length;

/** Where the holder of `headers` and a browser without a key are. */
class Site {
  constructor(server, headers) {
    this.server = server;
    this.headers = headers;
  }
  tickets(query = "") {
    return fetch(`${this.server.url}/v1/tickets?${query}`, { method: "POST", headers: this.headers });
  }
  async ticket(query = "") {
    return (await json(await this.tickets(query), 200)).urls[0];
  }
  /** Of a browser: without a key. */
  open(url, init = {}) {
    return fetch(this.server.url + url, init);
  }
  send(url, { mesh = grid(4), query = QUICK, headers = {} } = {}) {
    return this.open(`${url}&${query}`, { method: "POST", headers: { ...kObj, ...headers }, body: mesh });
  }
}

async function site(t, { flags = [], options = [] } = {}) {
  const data = dataDirectory(t);
  const headers = holder(data, "site", ...flags);
  const server = await Server.start(data, "--require-keys", ...options);
  return { at: new Site(server, headers), data };
}

const isEnd = (text) => /^event: succeeded$/m.test(text);

test("a link opens the events of a job, or the job, until its key is removed", async (t) => {
  const { at, data } = await site(t);
  const headers = { ...at.headers, ...kObj };
  const { id } = await json(await at.open(`/v1/jobs?${QUICK}`, { method: "POST", headers, body: grid(4) }), 202);
  const link = async (file) =>
    (await json(await at.open(`/v1/jobs/${id}/link?file=${file}`, { headers: at.headers }), 200)).url;
  const [events, job] = [await link("events"), await link("job")];
  assert.ok(isEnd(await (await at.open(events)).text()));
  const late = await (await at.open(events, { headers: { "Last-Event-ID": "1" } })).text();
  assert.ok(isEnd(late) && !/^event: queued$/m.test(late), "the stream goes on where it was");
  assert.equal((await json(await at.open(job), 200)).id, id);
  await refused(await at.open(job, { method: "DELETE" }), 403, "invalid_link");
  await refused(await at.open(events.replace("/events", "/report")), 403, "invalid_link");
  await refused(await at.open(events.replace(/expires=\d+/, "expires=99999999999")), 403, "invalid_link");
  keys(data, "remove", keys(data, "list").split(" ")[0]);
  for (const url of [events, job]) await refused(await at.open(url), 403, "invalid_link");
});

test("a ticket takes one job, whose links need no key", async (t) => {
  const { at } = await site(t);
  const url = await at.ticket();
  const job = await json(await at.send(url, { query: `${QUICK}&name=of+a+page` }), 202);
  assert.equal(job.name, "of a page");
  const read = async (name) => (await at.open(job.links[name])).text();
  assert.ok(isEnd(await read("events")));
  assert.match(await read("result"), /^vt /m);
  assert.equal(JSON.parse(await read("report")).options.stop.iterations, 2);
  assert.equal(JSON.parse(await read("self")).state, "succeeded");
  await refused(await at.open(`/v1/jobs/${job.id}`), 401, "unauthorized");
  const listed = await json(await at.open("/v1/jobs", { headers: at.headers }), 200);
  assert.deepEqual(listed.jobs.map(({ id }) => id), [job.id], "it is the holder's");

  assert.equal((await json(await at.send(url), 202)).id, job.id, "the same request gets the same job");
  await refused(await at.send(url, { mesh: grid(5) }), 409, "idempotency_conflict");
  const gone = await at.open(`/v1/jobs/${job.id}`, { method: "DELETE", headers: at.headers });
  assert.equal(gone.status, 204);
  await refused(await at.send(url), 403, "invalid_link");
  assert.equal((await json(await at.open("/v1/jobs", { headers: at.headers }), 200)).jobs.length, 0);
});

test("a ticket is spent over a restart", async (t) => {
  const { at, data } = await site(t);
  const url = await at.ticket();
  const { id } = await json(await at.send(url, { headers: { Prefer: "wait=60" } }), 200);
  assert.equal((await at.open(`/v1/jobs/${id}`, { method: "DELETE", headers: at.headers })).status, 204);
  await at.server.end("SIGTERM");
  at.server = await Server.start(data, "--require-keys");
  await refused(await at.send(url), 403, "invalid_link");
});

test("a ticket also sends a form, and watches its job", async (t) => {
  const { at } = await site(t);
  const body = new FormData();
  body.append("stop.iterations", "2");
  body.append("file", new Blob([grid(4)]), "grid.obj");
  assert.equal((await at.open(await at.ticket(), { method: "POST", body })).status, 202);
  const watched = await at.send(await at.ticket(), { headers: { Accept: "text/event-stream" } });
  const text = await watched.text();
  assert.ok(isEnd(text));
  const accepted = JSON.parse(text.match(/^event: accepted\ndata: (.*)$/m)[1]);
  assert.equal((await at.open(accepted.links.result)).status, 200);
});

test("a ticket's life, size and place are signed with it", async (t) => {
  const { at, data } = await site(t);
  const url = await at.ticket(`max_bytes=${size}`);
  const changed = [
    url.replace(/max_bytes=\d+/, `max_bytes=${2 * size}`),
    url.replace(/expires=\d+/, "expires=99999999999"),
    url.replace(/ticket=./, (start) => (start.endsWith("0") ? "ticket=1" : "ticket=0")),
    url.replace(/key=k_\w+/, "key=k_file"),
    url.replace(/.$/, (digit) => (digit === "0" ? "1" : "0")),
    url.replace("/v1/jobs", "/v1/unwrap"),
    url.replace("/v1/jobs", "/v1/tickets"),
  ];
  for (const other of changed) await refused(await at.send(other), 403, "invalid_link");
  await refused(await at.open(url), 403, "invalid_link");
  await refused(await at.send(url, { mesh: `${grid(4)}#` }), 413, "body_too_large");
  const form = new FormData();
  form.append("file", new Blob([`${grid(4)}#`]), "grid.obj");
  await refused(await at.open(url, { method: "POST", body: form }), 413, "body_too_large");
  await refused(await at.send(url, { headers: { "Unwrapd-Webhook": "https://example.com/" } }), 403, "forbidden");
  const named = { headers: { "Content-Type": "application/json" }, mesh: `{"mesh":"${"0".repeat(64)}"}`, query: "" };
  await refused(await at.send(url, named), 403, "forbidden");
  assert.equal((await at.send(url)).status, 202, "refusals did not spend it");
  const short = await at.ticket("seconds=1");
  while (Date.now() / 1000 < Number(short.match(/expires=(\d+)/)[1]) + 1) await new Promise((done) => setTimeout(done, 50));
  await refused(await at.send(short), 403, "invalid_link");
  const last = await at.ticket();
  keys(data, "remove", keys(data, "list").split(" ")[0]);
  await refused(await at.send(last), 403, "invalid_link");
});

test("tickets are for who may submit, and count for the quota of the key", async (t) => {
  const { at, data } = await site(t, { flags: ["--max-jobs", "1"] });
  await refused(await new Site(at.server, {}).tickets(), 401, "unauthorized");
  await refused(await new Site(at.server, holder(data, "reader", "--scopes", "read")).tickets(), 403, "forbidden");
  for (const query of ["seconds=0", "seconds=86401", "count=101", "max_bytes=0", "max_bytes=1e3", "count=1&count=1", "size=1"])
    await refused(await at.tickets(query), 422, "invalid_option");
  const seldom = new Site(at.server, holder(data, "seldom", "--requests-per-minute", "1"));
  await refused(await at.send(await seldom.ticket()), 429, "rate_limited");
  const { urls, expires, max_bytes: bytes } = await json(await at.tickets("count=2&max_bytes=100000&seconds=60"), 200);
  assert.deepEqual([new Set(urls).size, bytes], [2, 100_000]);
  assert.ok(Math.abs(new Date(expires) - Date.now() - 60_000) < 30_000);
  assert.equal((await at.send(urls[0], { mesh: grid(20), query: "stop.iterations=10000" })).status, 202);
  for (let k = 0; k < 2; ++k) await refused(await at.send(urls[1]), 429, "too_many_jobs");
});

test("two that send one ticket at once make one job", async (t) => {
  const { at } = await site(t);
  for (let round = 0; round < 10; round++) {
    const url = await at.ticket();
    const answers = await Promise.all(Array.from({ length: 8 }, () => at.send(url)));
    const ids = new Set();
    for (const answer of answers) ids.add((await json(answer, 202)).id);
    assert.equal(ids.size, 1);
  }
});

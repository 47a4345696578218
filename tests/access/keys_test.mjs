// The real server with API keys: who has none, or one of too little, is told so; nobody sees the
// jobs of another; and no key comes into the log.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { createHash } from "node:crypto";
import { chmodSync, existsSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";

import { dataDirectory, ENDLESS, grid, QUICK, Server } from "../fault/server.mjs";

/** A new key's text. */
function addKey(data, name, ...flags) {
  const args = ["keys", "add", "--data", data, "--name", name, ...flags];
  return execFileSync(process.env.UNWRAPD, args, { stdio: ["ignore", "pipe", "ignore"] })
    .toString()
    .trim();
}

/** What the holder of a key (or of none) does at a server. */
class Holder {
  constructor(server, key) {
    this.server = server;
    this.headers = key ? { Authorization: `Bearer ${key}` } : {};
  }
  fetch(path, options = {}) {
    const headers = { ...this.headers, ...options.headers };
    return fetch(`${this.server.url}${path}`, { ...options, headers });
  }
  post(query = QUICK, size = 3, more = {}) {
    const headers = { "Content-Type": "model/obj", "Cache-Control": "no-cache", ...more };
    return this.fetch(`/v1/jobs?${query}`, { method: "POST", headers, body: grid(size) });
  }
  async submit(query, size, more) {
    const answer = await this.post(query, size, more);
    const job = await answer.json();
    assert.ok(answer.ok, JSON.stringify(job));
    return job.id;
  }
  async done(query, size) {
    return this.submit(query, size, { Prefer: "wait=60" });
  }
  async ids() {
    return (await (await this.fetch("/v1/jobs?limit=200")).json()).jobs.map(({ id }) => id);
  }
  async state(id) {
    return (await (await this.fetch(`/v1/jobs/${id}`)).json()).state;
  }
}

async function refused(answer, status, code) {
  const problem = await answer.json();
  assert.deepEqual([answer.status, problem.code], [status, code], problem.detail);
  return answer.headers;
}

test("without a key there are the contract and the probes, and nothing else", async (t) => {
  const data = dataDirectory(t);
  const server = await Server.start(data, "--require-keys");
  const nobody = new Holder(server);
  for (const path of ["/healthz", "/readyz", "/v1/limits", "/v1/methods", "/openapi.yaml"])
    assert.equal((await nobody.fetch(path)).status, 200, path);
  const job = `/v1/jobs/j_${"0".repeat(32)}`;
  for (const path of ["/v1/jobs", job, `${job}/result`, `${job}/events`, `${job}/link`]) {
    const headers = await refused(await nobody.fetch(path), 401, "unauthorized");
    assert.equal(headers.get("WWW-Authenticate"), "Bearer");
  }
  const small = { Authorization: `bearer ${addKey(data, "a")}` }; // schemes have no case
  assert.equal((await nobody.fetch("/v1/jobs", { headers: small })).status, 200);
  for (const file of readdirSync(data))
    assert.equal(statSync(join(data, file)).mode & 0o007, 0, `${file} is of its user and group alone`);
  await refused(await nobody.post(), 401, "unauthorized");
  await refused(await nobody.fetch(job, { method: "DELETE" }), 401, "unauthorized");
  await refused(await new Holder(server, "unw_nonsense").post(), 401, "unauthorized");
  await server.end("SIGTERM");
});

test("a key sees its own jobs alone; admin sees all; a removed key sees nothing", async (t) => {
  const data = dataDirectory(t);
  const keys = ["a", "b"].map((name) => addKey(data, name));
  const adminKey = addKey(data, "boss", "--scopes", "admin");
  const server = await Server.start(data, "--require-keys", "--log-level", "debug");
  const [a, b] = keys.map((key) => new Holder(server, key));
  const admin = new Holder(server, adminKey);
  const job = await a.done();
  const other = await b.done();
  assert.deepEqual(await a.ids(), [job]);
  assert.deepEqual(await b.ids(), [other]);
  assert.deepEqual(await admin.ids(), [other, job]);
  for (const file of ["", "/result", "/report", "/events", "/layout.svg", "/preview.png", "/link"]) {
    await refused(await b.fetch(`/v1/jobs/${job}${file}`), 404, "not_found");
    assert.equal((await a.fetch(`/v1/jobs/${job}${file}`)).status, 200, file);
    assert.equal((await admin.fetch(`/v1/jobs/${job}${file}`)).status, 200, file);
  }
  await refused(await b.fetch(`/v1/jobs/${job}`, { method: "DELETE" }), 404, "not_found");
  const put = { method: "PUT", headers: { "Content-Type": "model/obj" }, body: grid(2) };
  await refused(await b.fetch(`/v1/jobs/${job}`, put), 404, "not_found");
  assert.equal(await a.state(job), "succeeded");

  const { url } = await (await a.fetch(`/v1/jobs/${job}/link`)).json();
  const result = await (await a.fetch(`/v1/jobs/${job}/result`)).text();
  assert.equal(await (await fetch(server.url + url)).text(), result, "a link needs no key");
  await refused(await fetch(server.url + url.replace("/result", "/report")), 403, "invalid_link");

  const list = execFileSync(process.env.UNWRAPD, ["keys", "list", "--data", data]).toString();
  const id = list.split("\n").find((line) => line.endsWith(" a")).split(" ")[0];
  execFileSync(process.env.UNWRAPD, ["keys", "remove", id, "--data", data]);
  await refused(await a.fetch(`/v1/jobs/${job}`), 401, "unauthorized");
  await refused(await fetch(server.url + url), 403, "invalid_link");
  const signature = url.split("signature=")[1];
  await server.end("SIGTERM");
  assert.ok(server.log.length > 0);
  for (const secret of [...keys, adminKey, signature])
    for (const text of [server.log, list]) assert.ok(!text.includes(secret.slice(-40)), "a secret");
});

test("the command makes no directory, secret or key for a slip of the pen", (t) => {
  const data = dataDirectory(t);
  const keys = (...args) => spawnSync(process.env.UNWRAPD, ["keys", ...args], { encoding: "utf8" });
  const missing = join(data, "typo");
  for (const args of [["list"], ["remove", "k_0"], ["webhook-secret"], ["webhook-secret", "k_file"]]) {
    const { status, stderr } = keys(...args, "--data", missing);
    assert.deepEqual([status, stderr.includes(join(missing, "keys.sqlite"))], [1, true], `${args}: ${stderr}`);
  }
  assert.ok(!existsSync(missing));
  addKey(data, "a");
  const { status, stdout } = keys("webhook-secret", "k_nope", "--data", data);
  assert.deepEqual([status, stdout], [1, ""]);
  assert.ok(!existsSync(join(data, "secret")));
  const id = keys("list", "--data", data).stdout.split(" ")[0];
  const secrets = [[id], ["k_file"], []].map((of) => keys("webhook-secret", ...of, "--data", data).stdout);
  assert.equal(new Set(secrets).size, 3);
  for (const secret of secrets) assert.match(secret, /^whsec_/);
  assert.equal(keys("add", "--name", "a\nk_1", "--data", data).status, 1);

  const file = join(data, "server.toml");
  writeFileSync(file, `data = "${data}"\nworkers = 1\n`);
  assert.match(keys("list", "--config", file).stdout, / a$/m);
  assert.equal(keys("list", "--config", file, "--data", missing).status, 1, "a flag overrides the file");
  assert.match(keys("list", "--config", join(data, "none.toml")).stderr, /none\.toml/);
});

test("a key's meshes are its own, and count once", async (t) => {
  const data = dataDirectory(t);
  const mesh = grid(30);
  const sha256 = createHash("sha256").update(mesh).digest("hex");
  const most = Math.round(mesh.length * 1.5); // room for it once, and for small results
  const [a, b, boss] = [
    ["a", "--max-bytes", String(most)],
    ["b"],
    ["boss", "--scopes", "admin"],
  ].map((flags) => addKey(data, ...flags));
  const server = await Server.start(data, "--require-keys");
  const holders = [a, b, boss].map((key) => new Holder(server, key));
  const put = (holder, body = mesh, name = sha256) =>
    holder.fetch(`/v1/meshes/${name}`, { method: "PUT", headers: { "Content-Type": "model/obj" }, body });
  const job = (holder, method) =>
    holder.fetch("/v1/jobs", {
      method: "POST",
      headers: { "Content-Type": "application/json", "Cache-Control": "no-cache" },
      body: JSON.stringify({ mesh: sha256, options: { method, stop: { iterations: 10_000 } } }),
    });
  const [mine, ...others] = holders;
  assert.equal((await put(mine)).status, 201);
  for (const other of others) {
    await refused(await other.fetch(`/v1/meshes/${sha256}`), 404, "mesh_not_found");
    await refused(await job(other, "arap"), 404, "mesh_not_found");
    assert.equal((await put(other)).status, 201, "each has its own");
  }
  assert.equal((await put(mine)).status, 200);
  const jobs = await Promise.all(["arap", "slim", "hybrid"].map((method) => job(mine, method)));
  for (const answer of jobs) assert.equal(answer.status, 202, await answer.clone().text());
  await refused(await mine.post(QUICK, 29), 507, "quota_exceeded");
  const second = grid(29);
  const name = createHash("sha256").update(second).digest("hex");
  await refused(await put(mine, second, name), 507, "quota_exceeded");
  for (const folder of readdirSync(join(data, "blobs")).filter((own) => own.startsWith("m_"))) {
    const document = join(data, "blobs", folder, "document");
    chmodSync(document, 0o600);
    writeFileSync(document, mesh.toString().replace("v", "w"));
  }
  await refused(await job(mine, "asap"), 500, "storage_corrupt");
  assert.equal((await put(mine)).status, 201, "a damaged one is replaced, whatever the quota");
  for (const answer of jobs) {
    const { id } = await answer.json();
    await mine.fetch(`/v1/jobs/${id}`, { method: "DELETE" });
  }
  await server.end("SIGTERM");
});

test("scopes, rates and quotas are kept, each by its code", async (t) => {
  const data = dataDirectory(t);
  const add = (...flags) => addKey(data, flags.join(" "), ...flags);
  const keys = {
    submit: add("--scopes", "submit"),
    read: add("--scopes", "read"),
    rare: add("--requests-per-minute", "2"),
    one: add("--max-jobs", "1"),
    small: add("--max-bytes", "9000"),
    drawing: add("--max-bytes", "43000"), // two jobs, and a picture of 21 kB
  };
  const server = await Server.start(data, "--require-keys");
  const as = (name) => new Holder(server, keys[name]);
  const id = await as("submit").submit();
  await refused(await as("submit").fetch(`/v1/jobs/${id}`), 403, "forbidden");
  await refused(await as("read").post(), 403, "forbidden");
  for (let k = 0; k < 2; ++k) assert.equal((await as("rare").fetch("/v1/jobs")).status, 200);
  const rate = await refused(await as("rare").fetch("/v1/jobs"), 429, "rate_limited");
  assert.ok(Number(rate.get("Retry-After")) >= 1 && Number(rate.get("Retry-After")) <= 30);
  const live = await as("one").submit(...ENDLESS);
  const busy = await refused(await as("one").post(), 429, "too_many_jobs");
  assert.ok(Number(busy.get("Retry-After")) >= 1);
  await as("one").fetch(`/v1/jobs/${live}`, { method: "DELETE" });
  const kept = await as("small").done(QUICK, 5);
  await refused(await as("small").post(QUICK, 12), 507, "quota_exceeded");
  await as("small").fetch(`/v1/jobs/${kept}`, { method: "DELETE" });
  assert.equal((await as("small").post(QUICK, 5)).status, 202);
  const drawn = await as("drawing").done(QUICK, 5);
  await as("drawing").done(QUICK, 5);
  for (const size of [128, 64]) { // the first is kept with the job, and then there is no room
    const answer = await as("drawing").fetch(`/v1/jobs/${drawn}/preview.png?size=${size}`);
    assert.equal(answer.status, 200);
  }
  const pictures = readdirSync(join(data, "blobs", drawn)).filter((file) => file.includes("png"));
  assert.deepEqual(pictures, ["uv.bin.preview.128.png"]);
  await refused(await as("drawing").post(QUICK, 12), 507, "quota_exceeded");
  await server.end("SIGTERM");
});

test("results count for their key before they are written, and take nothing from others", async (t) => {
  const data = dataDirectory(t);
  const most = 150_000;
  const [small, other] = [String(most), "0"].map((bytes) => addKey(data, bytes, "--max-bytes", bytes));
  const server = await Server.start(data, "--require-keys", "--max-disk-bytes", "1000000");
  const [his, another] = [small, other].map((key) => new Holder(server, key));
  const kept = await another.done(QUICK, 20);
  const curve = `method=hybrid&${QUICK}&lambda=${Array.from({ length: 32 }, (_, k) => k + 1)}`;
  const beyond = await (await his.fetch(`/v1/jobs/${await his.done(curve, 20)}`)).json();
  assert.deepEqual([beyond.state, beyond.problem.code], ["failed", "quota_exceeded"], JSON.stringify(beyond));
  while (existsSync(join(data, "blobs", beyond.id))) await new Promise((done) => setTimeout(done, 5));
  assert.equal((await another.fetch(`/v1/jobs/${kept}/result`)).status, 200);
  const fits = await his.done(QUICK, 20);
  const size = readdirSync(join(data, "blobs", fits))
    .reduce((sum, file) => sum + statSync(join(data, "blobs", fits, file)).size, 0);
  for (let k = 0; k * size < most; ++k) // the same question again shares its files: it takes no room
    assert.equal((await his.post(QUICK, 20, { "Cache-Control": "max-age=60" })).status, 202);
  const answers = [];
  for (let k = 0; k * size < most; ++k) answers.push(await his.post(QUICK, 20, { Prefer: "wait=60" }));
  const ends = await Promise.all(answers.map(async (answer) => await answer.json()));
  const codes = ends.map((end) => end.problem?.code ?? end.code);
  assert.equal(codes[0], 2 * size <= most ? undefined : "quota_exceeded");
  assert.equal(codes.at(-1), "quota_exceeded");
  await server.end("SIGTERM");
});

test("a request with long options is known again though its key may store no more", async (t) => {
  const data = dataDirectory(t);
  const server = await Server.start(data, "--require-keys");
  const held = Array.from({ length: 3000 }, (_, v) => ({ vertex: v, uv: [v / 3000, (v % 7) / 7] }));
  const options = JSON.stringify({ constraints: held, stop: { iterations: 1 } }, null, 1);
  const his = new Holder(server, addKey(data, "a", "--max-bytes", String(grid(60).length + options.length + 1)));
  const send = () => {
    const body = new FormData();
    body.append("options", new Blob([options], { type: "application/json" }));
    body.append("mesh", new Blob([grid(60)], { type: "model/obj" }), "grid.obj");
    return his.fetch("/v1/jobs", { method: "POST", headers: { "Idempotency-Key": "one" }, body });
  };
  const first = await send();
  const job = await first.json();
  assert.equal(first.status, 202, JSON.stringify(job));
  await refused(await his.post(QUICK, 60), 507, "quota_exceeded");
  const again = await (await send()).json();
  assert.equal(again.id, job.id, JSON.stringify(again));
  await server.end("SIGTERM");
});

test("keys take turns, and a key's own jobs go by their priority", async (t) => {
  const data = dataDirectory(t);
  const [greedy, modest] = ["greedy", "modest"].map((name) => addKey(data, name));
  const server = await Server.start(data, "--require-keys");
  const many = new Holder(server, greedy);
  const few = new Holder(server, modest);
  const blocker = await many.submit(...ENDLESS);
  const queued = [];
  for (let k = 0; k < 20; ++k) queued.push(await many.submit(QUICK, 100)); // some time each
  const late = await few.submit(QUICK, 8);
  const urgent = await many.submit(QUICK, 8, { Priority: "u=0" });
  await many.fetch(`/v1/jobs/${blocker}`, { method: "DELETE" });
  for (;;) {
    if ((await few.state(late)) !== "queued") break;
  }
  const states = await Promise.all(queued.map((id) => many.state(id)));
  const waiting = states.filter((state) => state === "queued").length;
  assert.ok(waiting >= 10, `${waiting} of the greedy key's 20 jobs wait when the modest key's runs`);
  while ((await many.state(urgent)) !== "succeeded") await new Promise((done) => setTimeout(done, 5));
  assert.equal(await many.state(queued.at(-1)), "queued", "the urgent job overtook its own queue");
  await server.end("SIGTERM");
});

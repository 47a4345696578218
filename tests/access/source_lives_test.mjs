// Sources among the rest of the service: many at once, clients that leave, ends of the server, names of
// requests, quotas and upload tickets.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { once } from "node:events";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, grid, Server } from "../fault/server.mjs";
import { accepted, ALLOWED, ask, files, isClean, obj, refused, upload } from "./source_files.mjs";

const MESH = grid(8);

/** The header fields of the holder of a new key. */
function holder(data, name, ...flags) {
  const args = ["keys", "add", "--name", name, "--data", data, ...flags];
  const key = execFileSync(process.env.UNWRAPD, args, { stdio: ["ignore", "pipe", "ignore"] }).toString().trim();
  return { Authorization: `Bearer ${key}` };
}

/** A server of files that begins /slow.obj and goes on with it when `finish` is called. */
async function slow(t) {
  const from = await files(t, (request, response) => {
    if (request.url !== "/slow.obj") return obj(MESH)(request, response);
    response.writeHead(200).write(MESH.slice(0, 1000));
  });
  from.finish = () => from.hits.forEach(({ url, response }) => url === "/slow.obj" && response.end(MESH.slice(1000)));
  return from;
}

test("only so many are read at once, and they keep no other request waiting", async (t) => {
  const from = await slow(t);
  const server = await Server.start(dataDirectory(t), ...ALLOWED, "--max-sources", "2", "--max-requests", "1");
  const reading = [ask(server, from.at("/slow.obj")), ask(server, from.at("/slow.obj"))];
  await from.called(2);
  const busy = await ask(server, from.at("/x.obj"));
  assert.ok(Number(busy.headers.get("Retry-After")) > 0);
  await refused(busy, 429, "rate_limited", null);
  assert.equal((await fetch(`${server.url}/v1/limits`)).status, 200);
  await accepted(await upload(server, grid(3)));
  from.finish();
  for (const answer of reading) await accepted(await answer);
  await accepted(await ask(server, from.at("/x.obj")));
  await server.end("SIGTERM");
});

test("nothing is read on for a client that has left", async (t) => {
  const from = await slow(t);
  const data = dataDirectory(t);
  const server = await Server.start(data, ...ALLOWED, "--max-sources", "1");
  const leaving = new AbortController();
  const asked = ask(server, from.at("/slow.obj"), { signal: leaving.signal });
  await from.called(1);
  leaving.abort();
  await assert.rejects(asked);
  if (!from.hits[0].response.destroyed) await once(from.hits[0].response, "close");
  while (!isClean(data)) await sleep(5);
  assert.deepEqual((await (await fetch(`${server.url}/v1/jobs`)).json()).jobs, []);
  await accepted(await ask(server, from.at("/x.obj"), { headers: { "Idempotency-Key": "place" } }));
  await server.end("SIGTERM");
});

test("a shutdown waits for no source", async (t) => {
  const from = await slow(t);
  const data = dataDirectory(t);
  const server = await Server.start(data, ...ALLOWED);
  const asked = ask(server, from.at("/slow.obj"));
  await from.called(1);
  const end = server.end("SIGTERM");
  await refused(await asked, 503, "draining", null);
  assert.deepEqual(await end, [0, null]);
  assert.ok(isClean(data));
});

test("a kill -9 loses nothing that was acknowledged, and leaves nothing of what was not", async (t) => {
  const from = await slow(t);
  const data = dataDirectory(t);
  const first = await Server.start(data, ...ALLOWED);
  const { id } = await accepted(await ask(first, from.at("/x.obj")));
  const cut = ask(first, from.at("/slow.obj"), { headers: { "Idempotency-Key": "again" } });
  await from.called(2);
  const lost = assert.rejects(cut);
  await first.end("SIGKILL");
  await lost;
  const second = await Server.start(data, ...ALLOWED);
  assert.equal((await second.finished(id)).state, "succeeded");
  assert.deepEqual((await (await fetch(`${second.url}/v1/jobs`)).json()).jobs.map((job) => job.id), [id]);
  assert.ok(isClean(data));
  assert.equal(from.hits.length, 2, "what was stored is not read again");
  const again = ask(second, from.at("/slow.obj"), { headers: { "Idempotency-Key": "again" } });
  await from.called(3);
  from.finish();
  await accepted(await again);
  await second.end("SIGTERM");
});

test("a request with a name may come again, by the address or by the bytes", async (t) => {
  let mesh = MESH;
  const from = await files(t, (request, response) => obj(mesh)(request, response));
  const data = dataDirectory(t);
  const server = await Server.start(data, ...ALLOWED);
  const headers = { "Idempotency-Key": "one" };
  const { id } = await accepted(await ask(server, from.at("/x.obj?signed=1"), { headers }));
  assert.equal((await accepted(await ask(server, from.at("/x.obj?signed=2"), { headers }))).id, id);
  assert.equal((await accepted(await upload(server, MESH, headers))).id, id);
  mesh = grid(9);
  await refused(await ask(server, from.at("/x.obj?signed=1"), { headers }), 409, "idempotency_conflict", null);
  const job = (await fetch(`${server.url}/v1/jobs`)).json();
  assert.equal((await job).jobs.length, 1);
  await server.end("SIGTERM");
});

test("a source counts for the quota of its key", async (t) => {
  const from = await files(t, obj(MESH));
  const data = dataDirectory(t);
  const server = await Server.start(data, ...ALLOWED, "--require-keys");
  await refused(await ask(server, from.at("/x.obj")), 401, "unauthorized", null);
  const poor = holder(data, "poor", "--max-bytes", String(MESH.length - 1));
  await refused(await ask(server, from.at("/x.obj"), { headers: poor }), 507, "quota_exceeded", null);
  const reader = holder(data, "reader", "--scopes", "read");
  await refused(await ask(server, from.at("/x.obj"), { headers: reader }), 403, "forbidden", null);
  assert.equal(from.hits.length, 1, "who may not submit makes the server read nothing");
  assert.ok(isClean(data));
  await accepted(await ask(server, from.at("/x.obj"), { headers: holder(data, "rich") }));
  await server.end("SIGTERM");
});

test("an upload ticket takes a source of its size, once", async (t) => {
  const from = await files(t, obj(MESH));
  const data = dataDirectory(t);
  const server = await Server.start(data, ...ALLOWED, "--require-keys");
  const headers = holder(data, "site");
  const ticket = async (query) =>
    (await (await fetch(`${server.url}/v1/tickets?${query}`, { method: "POST", headers })).json()).urls[0];
  const small = await ticket(`max_bytes=${MESH.length - 1}`);
  await refused(await ask(server, from.at("/x.obj"), { path: small }), 413, "body_too_large", null);
  const url = await ticket(`max_bytes=${MESH.length}`);
  const mesh = { path: url, body: { mesh: "0".repeat(64) } };
  await refused(await ask(server, "", mesh), 403, "forbidden", null);
  const job = await accepted(await ask(server, from.at("/x.obj"), { path: url }));
  assert.match(job.links.result, /signature=/);
  assert.equal((await accepted(await ask(server, from.at("/x.obj"), { path: url }))).id, job.id);
  await refused(await ask(server, from.at("/x.obj"), { path: url, body: { source: from.at("/x.obj") } }),
    409, "idempotency_conflict", null);
  await server.end("SIGTERM");
});

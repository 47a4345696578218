// Webhooks of the real server at a receiver on this machine: signed, tried again, over a kill -9, and
// never sent to addresses that are not public unless the operator says so.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createHmac } from "node:crypto";
import { once } from "node:events";
import { createServer } from "node:http";
import { createServer as createNetServer } from "node:net";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, grid, QUICK, Server } from "../fault/server.mjs";

const ALLOWED = ["--webhook-hosts", "localhost", "--webhook-private", "--webhook-retry-seconds", "1"];

/** A receiver that answers by `status`, or never without one; what it got, and how much at once. */
async function receiver(t, address = "127.0.0.1") {
  const calls = [];
  const hook = { calls, status: 200, open: 0, most: 0 };
  const http = createServer(async (request, answer) => {
    hook.most = Math.max(hook.most, ++hook.open);
    answer.on("close", () => hook.open--);
    const pieces = [];
    for await (const piece of request) pieces.push(piece);
    calls.push({ headers: request.headers, url: request.url, body: Buffer.concat(pieces).toString() });
    if (hook.status === 200) answer.writeEarlyHints({ link: "</a>; rel=preload" });
    if (hook.status) answer.writeHead(hook.status, hook.status === 302 ? { Location: "/elsewhere" } : {}).end();
  });
  http.listen(0, address);
  await once(http, "listening");
  t.after(() => http.close());
  hook.url = `http://localhost:${http.address().port}/done?a=b`;
  hook.called = async (times) => {
    while (calls.length < times) await sleep(10);
  };
  return hook;
}

function submit(server, url, query = QUICK, more = {}) {
  const headers = { "Content-Type": "model/obj", "Unwrapd-Webhook": url, ...more };
  return fetch(`${server.url}/v1/jobs?${query}`, { method: "POST", headers, body: grid(3) });
}

/** Checks a call by the specification, not by our code. */
function assertSigned(call, secret) {
  const key = Buffer.from(secret.replace("whsec_", ""), "base64");
  const text = `${call.headers["webhook-id"]}.${call.headers["webhook-timestamp"]}.${call.body}`;
  const expected = `v1,${createHmac("sha256", key).update(text).digest("base64")}`;
  assert.equal(call.headers["webhook-signature"], expected);
}

test("a webhook is called, signed, until it answers, over a kill -9", async (t) => {
  const data = dataDirectory(t);
  const hook = await receiver(t);
  hook.status = 500;
  const first = await Server.start(data, ...ALLOWED);
  const { id } = await (await submit(first, hook.url)).json();
  await hook.called(1);
  await first.end("SIGKILL");
  hook.status = 302; // a redirect is no answer, and is not followed
  const second = await Server.start(data, ...ALLOWED, "--log-level", "info");
  const before = hook.calls.length;
  await hook.called(before + 1);
  hook.status = 204;
  while (!second.log.includes("webhook called")) await sleep(10);
  const secret = execFileSync(process.env.UNWRAPD, ["keys", "webhook-secret", "--data", data]).toString().trim();
  for (const call of hook.calls) {
    assertSigned(call, secret);
    assert.equal(call.url, "/done?a=b");
    assert.match(call.headers["user-agent"], /^unwrapd\/\d/);
    assert.equal(call.headers["webhook-id"], id);
    assert.deepEqual(JSON.parse(call.body), await second.job(id));
  }
  await second.end("SIGTERM");
  assert.ok(!second.log.includes(secret.slice(6)) && !second.log.includes("done?a=b"));
});

test("a call is signed for its owner and tells its trace, also when the job is removed", async (t) => {
  const data = dataDirectory(t);
  const hook = await receiver(t);
  hook.status = 500;
  const keys = (...args) => execFileSync(process.env.UNWRAPD, ["keys", ...args, "--data", data],
    { stdio: ["ignore", "pipe", "ignore"] }).toString().trim();
  const holder = { Authorization: `Bearer ${keys("add", "--name", "a")}` };
  const server = await Server.start(data, ...ALLOWED, "--require-keys", "--log-level", "info");
  const trace = "0af7651916cd43dd8448eb211c80319c";
  const more = { ...holder, traceparent: `00-${trace}-b7ad6b7169203331-01` };
  const { id } = await (await submit(server, hook.url, QUICK, more)).json();
  await hook.called(1);
  const removed = await fetch(`${server.url}/v1/jobs/${id}`, { method: "DELETE", headers: holder });
  assert.equal(removed.status, 204);
  await hook.called(2);
  const secret = keys("webhook-secret", keys("list").split(" ")[0]);
  for (const call of hook.calls) {
    assertSigned(call, secret);
    assert.match(call.headers.traceparent, new RegExp(`^00-${trace}-[0-9a-f]{16}-00$`));
  }
  await server.end("SIGTERM");
  const lines = server.log.trim().split("\n").map(JSON.parse).filter(({ job }) => job === id);
  assert.ok(lines.some(({ event }) => event === "webhook not reached"));
  for (const line of lines.filter(({ event }) => event !== "job removed")) assert.equal(line.trace, trace, line.event);
});

test("a receiver that hangs for one key keeps nobody else's calls waiting", async (t) => {
  const data = dataDirectory(t);
  const hangs = await receiver(t);
  hangs.status = 0;
  const answers = await receiver(t);
  const holder = (name) => ({ Authorization: `Bearer ${execFileSync(process.env.UNWRAPD,
    ["keys", "add", "--name", name, "--data", data], { stdio: ["ignore", "pipe", "ignore"] }).toString().trim()}` });
  const [one, other] = [holder("one"), holder("other")];
  const server = await Server.start(data, ...ALLOWED, "--require-keys");
  for (const path of ["a", "b", "c", "d"]) await submit(server, `${hangs.url}&${path}`, QUICK, one);
  await hangs.called(1);
  await submit(server, answers.url, QUICK, other);
  await answers.called(1);
  assert.equal(hangs.calls.length, 1);
  await server.end("SIGTERM");
});

test("a receiver that is gone is not called again", async (t) => {
  const hook = await receiver(t);
  hook.status = 410;
  const server = await Server.start(dataDirectory(t), ...ALLOWED, "--log-level", "info");
  await submit(server, hook.url);
  while (!server.log.includes("webhook given up")) await sleep(10);
  assert.equal(hook.calls.length, 1);
  await server.end("SIGTERM");
});

test("hosts that are not allowed are refused at once", async (t) => {
  const server = await Server.start(dataDirectory(t), ...ALLOWED);
  for (const url of ["http://127.0.0.1/", "http://example.com/", "file:///etc/passwd", "http://u@localhost/", ""]) {
    const answer = await submit(server, url);
    assert.deepEqual([answer.status, (await answer.json()).code], [422, "webhook_refused"], url);
  }
  await server.end("SIGTERM");
});

test("an address of this machine is never called unless that is allowed", async (t) => {
  const hook = await receiver(t);
  const server = await Server.start(dataDirectory(t), "--webhook-hosts", "*", "--log-level", "info");
  assert.equal((await submit(server, hook.url)).status, 202);
  for (const literal of ["127.0.0.1", "127.1", "[::1]"]) {
    const answer = await submit(server, hook.url.replace("localhost", literal));
    assert.deepEqual([answer.status, (await answer.json()).code], [422, "webhook_refused"], literal);
  }
  while (server.log.split("not public").length < 2) await sleep(10);
  assert.equal(hook.calls.length, 0);
  await server.end("SIGTERM");
});

test("a receiver that talks without end is cut off", async (t) => {
  let sent = 0;
  let gone;
  const cut = new Promise((resolve) => (gone = resolve));
  const endless = createNetServer((socket) => {
    const line = "a".repeat(65_536);
    const talk = () => {
      while (!socket.destroyed && socket.write(line, () => (sent += line.length)));
    };
    socket.on("error", () => {}).on("close", gone).on("drain", talk);
    socket.once("data", () => {
      socket.write("HTTP/1.1 200 OK\r\nX: ");
      talk();
    });
  });
  await new Promise((resolve) => endless.listen(0, "127.0.0.1", resolve));
  t.after(() => endless.close());
  const server = await Server.start(dataDirectory(t), "--webhook-hosts", "127.0.0.1", "--webhook-private");
  const began = Date.now();
  assert.equal((await submit(server, `http://127.0.0.1:${endless.address().port}/`)).status, 202);
  await cut;
  assert.ok(Date.now() - began < 12_000, "before the time of a call is over");
  assert.ok(sent < 32e6, `${sent} bytes`); // what the kernel holds for both, not what can be sent
  await server.end("SIGKILL");
});

test("a receiver that hangs delays its own calls only, and not the end", async (t) => {
  const data = dataDirectory(t);
  const hanging = await receiver(t);
  hanging.status = undefined;
  const prompt = await receiver(t);
  const flags = ["--webhook-hosts", "localhost,127.0.0.1", "--webhook-private"];
  const first = await Server.start(data, ...flags);
  for (let i = 2; i < 7; i++)
    assert.equal((await submit(first, hanging.url, `stop.iterations=${i}`)).status, 202);
  await hanging.called(1);
  assert.equal((await submit(first, prompt.url.replace("localhost", "127.0.0.1"))).status, 202);
  await prompt.called(1);
  assert.equal(hanging.most, 1); // of a host that has not answered yet
  assert.deepEqual(await first.end("SIGTERM"), [0, null]);
  const stuck = hanging.calls.length;
  hanging.status = 200;
  const second = await Server.start(data, ...flags); // what was cut off is called again
  await hanging.called(stuck + 5);
  const ids = hanging.calls.map((call) => call.headers["webhook-id"]);
  assert.equal(new Set(ids).size, 5);
  await second.end("SIGTERM");
});

test("with many receivers that hang, those that have answered and a new one are called", async (t) => {
  const bad = [];
  for (let i = 10; i < 20; i++) {
    const hanging = await receiver(t, `127.0.0.${i}`);
    hanging.status = undefined;
    hanging.url = hanging.url.replace("localhost", `127.0.0.${i}`);
    bad.push(hanging);
  }
  const prompt = await receiver(t);
  const server = await Server.start(dataDirectory(t), "--webhook-hosts", "*", "--webhook-private");
  const send = async (url) => assert.equal((await submit(server, url, `stop.iterations=${++sent}`)).status, 202);
  let sent = 1;
  await send(prompt.url);
  await prompt.called(1);
  for (const hanging of bad.slice(0, 4)) for (let k = 0; k < 3; k++) await send(hanging.url);
  await Promise.all(bad.slice(0, 4).map((hanging) => hanging.called(1)));
  const fresh = await receiver(t, "127.0.0.20");
  fresh.url = fresh.url.replace("localhost", "127.0.0.20");
  await send(fresh.url); // never called before: four that hang leave it a place
  await fresh.called(1);
  for (const hanging of bad) for (let k = 0; k < 2; k++) await send(hanging.url);
  await Promise.all(bad.slice(0, 8).map((hanging) => hanging.called(1)));
  for (let k = 0; k < 4; k++) await send(prompt.url);
  await prompt.called(5);
  await server.end("SIGTERM");
});

// The npm package against a server of the test's own, which refuses, breaks off and answers late.
import assert from "node:assert/strict";
import { once } from "node:events";
import { createServer } from "node:http";
import { after, before, test } from "node:test";

import { install } from "./installed.mjs";

const kJob = { id: "j_0123456789abcdef", state: "running", links: {
  self: "/v1/jobs/j_0123456789abcdef", events: "/v1/jobs/j_0123456789abcdef/events",
  result: "/v1/jobs/j_0123456789abcdef/result", report: "/v1/jobs/j_0123456789abcdef/report",
} };
const kDone = { ...kJob, state: "succeeded" };

let installed;
let client;

before(async () => {
  installed = install();
  client = await installed.load("index.js");
});

after(() => installed?.remove());

const frame = (id, event, data) => `id: ${id}\nevent: ${event}\ndata: ${JSON.stringify(data)}\n\n`;
const json = (response, value, status = 200, headers = {}) =>
  response.writeHead(status, { "Content-Type": "application/json", ...headers }).end(JSON.stringify(value));
const problem = (status, code) => ({ type: `urn:unwrapd:problem:${code}`, title: code, status, detail: "Because.", code });

/** How the server of a test answers when it has nothing special in mind. */
const kUsual = {
  "POST /v1/jobs": (request, response) => json(response, kJob, 202),
  [`GET ${kJob.links.events}`]: (request, response) => response.end(frame(1, "succeeded", kDone)),
  [`GET ${kJob.links.report}`]: (request, response) => json(response, { charts: [] }),
  [`GET ${kJob.links.result}`]: (request, response) => response.end("asset"),
};

/** Unwraps by a server with these answers; returns the result and the requests by name. */
async function unwrapBy(t, answers, settings = {}) {
  const seen = [];
  const server = createServer(async (request, response) => {
    request.resume();
    await once(request, "end");
    const name = `${request.method} ${request.url}`;
    seen.push({ name, headers: request.headers, at: Date.now() });
    ({ ...kUsual, ...answers })[name](request, response, seen.filter((one) => one.name === name).length);
  });
  await once(server.listen(0, "127.0.0.1"), "listening");
  t.after(() => server.closeAllConnections() ?? server.close());
  const base = `http://127.0.0.1:${server.address().port}`;
  const result = await client.unwrap(new Blob(["v 0 0 0"]), {}, { server: `${base}/`, ...settings });
  return { result, of: (name) => seen.filter((one) => one.name === name) };
}

test("a full queue is asked again after Retry-After, by the same name", async (t) => {
  const { of } = await unwrapBy(t, {
    "POST /v1/jobs": (request, response, time) =>
      time === 1 ? json(response, problem(429, "queue_full"), 429, { "Retry-After": "1" }) : json(response, kJob, 202),
  });
  const [first, second, ...others] = of("POST /v1/jobs");
  assert.ok(second.at - first.at >= 1000, `${second.at - first.at} ms`);
  assert.equal(others.length, 0);
  assert.match(first.headers["idempotency-key"], /^[!-~]{10,}$/);
  assert.equal(second.headers["idempotency-key"], first.headers["idempotency-key"]);
});

test("an answer that is lost is asked for again, by the same name", async (t) => {
  const { of } = await unwrapBy(t, {
    "POST /v1/jobs": (request, response, time) => (time < 3 ? response.destroy() : json(response, kJob, 202)),
  }, { idempotencyKey: "mine" });
  assert.deepEqual(of("POST /v1/jobs").map(({ headers }) => headers["idempotency-key"]), ["mine", "mine", "mine"]);
});

test("events continue after the last one that arrived", async (t) => {
  const told = [];
  const { of } = await unwrapBy(t, {
    [`GET ${kJob.links.events}`]: (request, response, time) => {
      if (time > 1) return response.end(frame(8, "succeeded", kDone));
      response.write(": a comment\n\n" + frame(6, "queued", { position: 0 }));
      const [half, rest] = frame(7, "stage", { name: "solve", fraction: 0.5 }).split("solve");
      setTimeout(() => response.write(half + "sol"), 50);
      setTimeout(() => response.write("ve" + rest), 100);
      setTimeout(() => response.destroy(), 150);
    },
  }, { onProgress: ({ fraction, event }) => told.push([event.id, event.event, fraction]) });
  assert.deepEqual(of(`GET ${kJob.links.events}`).map(({ headers }) => headers["last-event-id"]), [undefined, "7"]);
  assert.deepEqual(told, [[6, "queued", 0], [7, "stage", 0.5], [8, "succeeded", 1]]);
});

test("without a place among the streams the job's state is asked for", async (t) => {
  const { of } = await unwrapBy(t, {
    [`GET ${kJob.links.events}`]: (request, response) =>
      json(response, problem(503, "too_many_streams"), 503, { "Retry-After": "1" }),
    [`GET ${kJob.links.self}`]: (request, response, time) => json(response, time === 2 ? kDone : kJob),
  }, { retries: 1 });
  assert.equal(of(`GET ${kJob.links.self}`).length, 2);
});

test("a download that breaks off begins anew", async (t) => {
  const { result } = await unwrapBy(t, {
    [`GET ${kJob.links.result}`]: (request, response, time) => {
      response.writeHead(200, { "Content-Length": 5, "Content-Type": "model/obj" });
      if (time > 1) return response.end("asset");
      response.write("ass");
      setTimeout(() => response.destroy(), 50);
    },
  });
  assert.equal(await result.asset.text(), "asset");
  assert.equal(result.asset.type, "model/obj");
});

test("patience ends, and what is refused for good is not asked again", async (t) => {
  const busy = (request, response) => json(response, problem(429, "queue_full"), 429, { "Retry-After": "1" });
  await assert.rejects(unwrapBy(t, { "POST /v1/jobs": busy }, { retries: 1 }), { code: "queue_full", retryAfter: 1 });
  let asked = 0;
  const refused = (request, response) => json(response, problem(422, "invalid_option"), (asked += 1, 422));
  await assert.rejects(unwrapBy(t, { "POST /v1/jobs": refused }), { code: "invalid_option" });
  assert.equal(asked, 1);
  const stranger = (request, response) => response.writeHead(404).end("<html>");
  await assert.rejects(unwrapBy(t, { "POST /v1/jobs": stranger }), { code: "unexpected_answer", status: 404 });
  const welcome = (request, response) => response.writeHead(200).end("<html>");
  await assert.rejects(unwrapBy(t, { "POST /v1/jobs": welcome }), { code: "unexpected_answer", status: 200 });
  await assert.rejects(unwrapBy(t, {}, { server: "localhost:8080" }), RangeError);
});

test("the key is sent with each request; what onProgress throws is the caller's, and cancels", async (t) => {
  const { of } = await unwrapBy(t, {}, { key: "secret" });
  for (const name of Object.keys(kUsual)) assert.equal(of(name)[0].headers.authorization, "Bearer secret", name);
  const onProgress = () => { throw new RangeError("mine"); };
  let cancelled = 0;
  const cancel = (request, response) => response.writeHead((cancelled += 1) && 204).end();
  await assert.rejects(unwrapBy(t, { [`DELETE ${kJob.links.self}`]: cancel }, { onProgress }), RangeError);
  assert.equal(cancelled, 1);
});

test("a redirect to another origin gets no key", async (t) => {
  const seen = [];
  const bucket = createServer((request, response) => {
    seen.push([request.url, request.headers.authorization]);
    response.end("of the bucket");
  });
  await once(bucket.listen(0, "127.0.0.1"), "listening");
  t.after(() => bucket.close());
  const Location = `http://127.0.0.1:${bucket.address().port}/o?s=a%2Fb`;
  const { result } = await unwrapBy(t, {
    [`GET ${kJob.links.result}`]: (request, response) => response.writeHead(307, { Location }).end(),
  }, { key: "secret" });
  assert.equal(await result.asset.text(), "of the bucket");
  assert.deepEqual(seen, [["/o?s=a%2Fb", undefined]]);
});

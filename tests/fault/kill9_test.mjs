// The real server, killed and ended while it works: nothing is lost, nothing half written is left,
// and what was running runs again. UNWRAPD names the binary.
import assert from "node:assert/strict";
import { connect } from "node:net";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, ENDLESS, filesBelow, QUICK, Server } from "./server.mjs";

const LONG_SIZE = 60; // of a grid on which 10,000 iterations, which are the most, take longer
const LONG_MS = 4000; // of work: killed long before its end, and not long to wait for

/** The query of a job that takes some seconds on this machine, in this build, when it is idle. */
async function longQuery(t) {
  const server = await Server.start(dataDirectory(t));
  let least = Infinity; // ms of 500 iterations; the machine may be busy with others now and then
  for (const size of [LONG_SIZE - 1, LONG_SIZE, LONG_SIZE + 1]) {
    const job = await server.finished(await server.submit("stop.iterations=500", size));
    const report = await (await fetch(`${server.url}${job.links.report}`)).json();
    least = Math.min(least, report.timings_ms.solve);
  }
  await server.end("SIGTERM");
  const iterations = Math.round((500 * LONG_MS) / least);
  return `stop.iterations=${Math.min(Math.max(iterations, 500), 10_000)}`;
}

/** An upload that stops half-way; resolves when the server has begun to store it. */
async function beginUpload(server, data) {
  const { hostname, port } = new URL(server.url);
  const socket = connect(Number(port), hostname);
  socket.on("error", () => {}); // the server is killed
  socket.write(
    "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/obj\r\nContent-Length: 9000000\r\n\r\n",
  );
  socket.write("v 0 0 0\n".repeat(100_000));
  while (filesBelow(join(data, "incoming")).length === 0) await sleep(5);
}

/** The traces in the lines of a log about a job, and what these lines tell. */
function linesOf(log, id) {
  const lines = log.trim().split("\n").map((line) => JSON.parse(line)).filter(({ job }) => job === id);
  return { events: lines.map(({ event }) => event), traces: new Set(lines.map(({ trace }) => trace)) };
}

test("kill -9: what ran runs again, what waited waits, nothing partial remains", async (t) => {
  const data = dataDirectory(t);
  const first = await Server.start(data, "--log-level", "info");
  const done = await first.submit(QUICK, 6);
  await first.finished(done);
  const result = await (await fetch(`${first.url}/v1/jobs/${done}/result`)).text();
  const running = await first.submit(await longQuery(t), LONG_SIZE);
  const waiting = [await first.submit(QUICK, 4), await first.submit(QUICK, 5)];
  await first.iterates(running);
  await beginUpload(first, data);
  assert.deepEqual(await first.end("SIGKILL"), [null, "SIGKILL"]);

  const second = await Server.start(data, "--log-level", "info");
  assert.deepEqual(filesBelow(join(data, "incoming")), []);
  const again = await second.finished(running);
  assert.equal(again.state, "succeeded");
  assert.equal(again.attempt, 2);
  const events = await (await fetch(`${second.url}${again.links.events}`)).text();
  assert.match(events, /^id: 10000\d{5}$/m, "the second attempt goes on counting events");
  for (const id of waiting) {
    const job = await second.finished(id);
    assert.deepEqual([job.state, job.attempt], ["succeeded", 1]);
    assert.equal((await fetch(`${second.url}${job.links.result}`)).status, 200);
  }
  assert.equal(await (await fetch(`${second.url}/v1/jobs/${done}/result`)).text(), result);
  assert.deepEqual(filesBelow(join(data, "blobs")).filter((name) => name.endsWith(".part")), []);
  assert.deepEqual(await second.end("SIGTERM"), [0, null]);
  const [before, after] = [first, second].map(({ log }) => linesOf(log, running));
  assert.equal(before.traces.size, 1);
  assert.ok(after.events.includes("job without a worker found, queued again"), `${after.events}`);
  assert.deepEqual(after.traces, before.traces, "one trace over the crash");
});

test("a job that was asked to stop is not run again after kill -9", async (t) => {
  const data = dataDirectory(t);
  const first = await Server.start(data);
  const id = await first.submit(...ENDLESS);
  await first.iterates(id);
  // Killed in the same breath: the server may or may not get to stop the job, but has noted it.
  await fetch(`${first.url}/v1/jobs/${id}`, { method: "DELETE" });
  await first.end("SIGKILL");
  const second = await Server.start(data);
  assert.equal((await second.finished(id)).state, "cancelled");
  await second.end("SIGTERM");
});

test("a harmless job is not to blame for the deaths of its server, however many", async (t) => {
  const data = dataDirectory(t);
  let server = await Server.start(data);
  const id = await server.submit(...ENDLESS);
  for (let death = 1; death <= 4; death++) {
    await server.iterates(id);
    await server.end("SIGKILL");
    server = await Server.start(data);
  }
  assert.equal((await server.iterates(id)).attempt, 5);
  await server.end("SIGKILL");
});

test("SIGTERM: a running job is finished, then the exit code is 0", async (t) => {
  const data = dataDirectory(t);
  const first = await Server.start(data, "--drain-seconds", "300");
  const id = await first.submit(await longQuery(t), LONG_SIZE);
  await first.iterates(id);
  assert.deepEqual(await first.end("SIGTERM"), [0, null]);
  const second = await Server.start(data);
  const job = await second.job(id);
  assert.deepEqual([job.state, job.attempt], ["succeeded", 1]);
  await second.end("SIGINT");
});

test("SIGTERM without patience: the job runs again at the next start", async (t) => {
  const data = dataDirectory(t);
  const first = await Server.start(data, "--drain-seconds", "0");
  const id = await first.submit(await longQuery(t), LONG_SIZE);
  await first.iterates(id);
  assert.deepEqual(await first.end("SIGTERM"), [0, null]);
  const second = await Server.start(data);
  const job = await second.finished(id);
  assert.deepEqual([job.state, job.attempt], ["succeeded", 2]);
  await second.end("SIGTERM");
});

test("a second SIGTERM: nothing is waited for any more, and the job runs again at the next start", async (t) => {
  const data = dataDirectory(t);
  const first = await Server.start(data, "--drain-seconds", "300");
  const id = await first.submit(...ENDLESS);
  await first.iterates(id);
  first.process.kill("SIGTERM");
  while ((await fetch(`${first.url}/readyz`)).status !== 503) await sleep(5);
  assert.deepEqual(await first.end("SIGTERM"), [0, null]);
  const second = await Server.start(data);
  assert.equal((await second.iterates(id)).attempt, 2);
  await second.end("SIGKILL");
});

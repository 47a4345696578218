// Servers of files that jobs name by their address, and what the tests of sources ask of them.
import assert from "node:assert/strict";
import { once } from "node:events";
import { createServer } from "node:http";
import { createServer as createNetServer } from "node:net";
import { setTimeout as sleep } from "node:timers/promises";

import { filesBelow, QUICK } from "../fault/server.mjs";

/** Flags of a server that reads from this machine. */
export const ALLOWED = ["--source-hosts", "localhost", "--source-private", "--source-http"];
const OPTIONS = { stop: { iterations: 2 } };

async function listening(t, server, address) {
  server.listen(0, address);
  await once(server, "listening");
  t.after(() => {
    server.close();
    server.closeAllConnections?.();
  });
  return server.address().port;
}

/** A server whose answers `answer` writes; the requests that it got are its `hits`. */
export async function files(t, answer, address = "127.0.0.1", host = "localhost") {
  const hits = [];
  const http = createServer((request, response) => {
    request.on("error", () => {});
    response.on("error", () => {});
    hits.push({ url: request.url, headers: request.headers, response });
    answer(request, response);
  });
  const port = await listening(t, http, address);
  const called = async (times) => {
    while (hits.length < times) await sleep(5);
  };
  return { hits, called, port, at: (path) => `http://${host}:${port}${path}` };
}

/** A server that writes bytes of its own on each connection, once a request has come. */
export async function raw(t, write) {
  const net = createNetServer((socket) => {
    socket.on("error", () => {}).once("data", () => write(socket));
  });
  const port = await listening(t, net, "127.0.0.1");
  return `http://localhost:${port}/x.obj`;
}

/** Sends a file whole, as an OBJ. */
export const obj = (text) => (_, response) => response.writeHead(200, { "Content-Type": "model/obj" }).end(text);

/** Asks for a job on the mesh at an address. */
export function ask(server, source, { headers = {}, body = { source, options: OPTIONS }, path = "/v1/jobs", ...more } = {}) {
  return fetch(server.url + path, {
    method: "POST",
    headers: { "Content-Type": "application/json", ...headers },
    body: JSON.stringify(body),
    ...more,
  });
}

/** The same job by its bytes. */
export function upload(server, text, headers = {}) {
  return fetch(`${server.url}/v1/jobs?${QUICK}`, {
    method: "POST",
    headers: { "Content-Type": "model/obj", ...headers },
    body: text,
  });
}

/** The job of an answer that must be one. */
export async function accepted(answer) {
  const job = await answer.json();
  assert.ok([200, 202].includes(answer.status), JSON.stringify(job));
  return job;
}

/** The words of a refusal, which must be this one; null for no pointer. */
export async function refused(answer, status, code, pointer = "/source") {
  const problem = await answer.json();
  assert.deepEqual([answer.status, problem.code, problem.pointer ?? null], [status, code, pointer], JSON.stringify(problem));
  return problem.detail;
}

/** Whether nothing of an upload is left in a data directory. */
export const isClean = (data) => filesBelow(`${data}/incoming`).length === 0;

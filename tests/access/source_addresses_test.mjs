// Which addresses a source is read from, in a network whose names resolve to whatever a test needs
// (own_network.sh). Behind every private address is a server that would answer.
import assert from "node:assert/strict";
import test from "node:test";

import { dataDirectory, grid, Server } from "../fault/server.mjs";
import { accepted, ask, files, isClean, obj, refused } from "./source_files.mjs";

const MESH = grid(8);
const ANYWHERE = ["--source-hosts", "*", "--source-http"];
const NAMES = ["metadata.example", "loop.example", "mapped.example", "private.example", "mixed.example", "localhost"];
const NUMBERS = ["127.0.0.1", "127.1", "0x7f000001", "2130706433", "[::1]", "[::ffff:127.0.0.1]", "[::ffff:a00:1]",
  "10.0.0.1", "169.254.169.254", "0.0.0.0", "[::]"];

/** Where everything is served, at every address of this machine. */
async function everywhere(t) {
  const from = await files(t, (request, response) => {
    if (request.url.startsWith("/to?")) return response.writeHead(302, { Location: request.url.slice(4) }).end();
    obj(MESH)(request, response);
  }, "::", "public.example");
  from.on = (host) => `http://${host}:${from.port}/x.obj`;
  return from;
}

test("a public address is read, and no other, however it is named", async (t) => {
  const from = await everywhere(t);
  const data = dataDirectory(t);
  const server = await Server.start(data, ...ANYWHERE);
  await accepted(await ask(server, from.at("/x.obj")));
  await accepted(await ask(server, from.on("93.184.216.34")));
  assert.equal(from.hits.length, 2);
  for (const host of [...NAMES, ...NUMBERS]) {
    const words = await refused(await ask(server, from.on(host)), 422, "source_refused");
    assert.match(words, /^This server may not read meshes from \S+; send the bytes/);
  }
  assert.equal(from.hits.length, 2);
  assert.ok(isClean(data));
  await server.end("SIGTERM");
});

test("a redirect to a private address is not followed", async (t) => {
  const from = await everywhere(t);
  const server = await Server.start(dataDirectory(t), ...ANYWHERE);
  await accepted(await ask(server, from.at(`/to?${from.on("93.184.216.34")}`)));
  for (const host of [...NAMES, ...NUMBERS]) {
    const before = from.hits.length;
    const words = await refused(await ask(server, from.at(`/to?${from.on(host)}`)), 422, "source_refused");
    assert.match(words, /^The source redirects to an address that this server may not read; send/);
    assert.equal(from.hits.length, before + 1, host);
  }
  await server.end("SIGTERM");
});

test("a name that is not known, and one that is private, are told apart only where the host is allowed", async (t) => {
  const from = await everywhere(t);
  const server = await Server.start(dataDirectory(t), "--source-hosts", "*.example", "--source-http");
  const outside = await refused(await ask(server, "http://nowhere.invalid/x.obj"), 422, "source_refused");
  const inside = await refused(await ask(server, from.on("private.example")), 422, "source_refused");
  assert.equal(outside.replace("nowhere.invalid", "HOST"), inside.replace("private.example", "HOST"));
  await refused(await ask(server, "http://nowhere.example/x.obj"), 422, "source_failed");
  await server.end("SIGTERM");
});

test("the operator can allow private addresses", async (t) => {
  const from = await everywhere(t);
  const server = await Server.start(dataDirectory(t), ...ANYWHERE, "--source-private");
  for (const host of ["private.example", "10.0.0.1", "loop.example"]) await accepted(await ask(server, from.on(host)));
  await server.end("SIGTERM");
});

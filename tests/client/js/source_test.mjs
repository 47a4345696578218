// unwrap() of a URL, which the server reads. UNWRAPD is the server.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { files, obj } from "../../access/source_files.mjs";
import { dataDirectory, grid, Server } from "../../fault/server.mjs";
import { install } from "./installed.mjs";

let installed;
let client;

before(async () => {
  installed = install();
  client = await installed.load("index.js");
});

after(() => installed?.remove());

test("a URL gives what its bytes give, where the server reads it", async (t) => {
  const mesh = grid(4);
  const from = await files(t, (request, response) =>
    request.url === "/grid.obj" ? obj(mesh)(request, response) : response.writeHead(404).end());
  const reads = await Server.start(dataDirectory(t), "--source-hosts", "localhost", "--source-private", "--source-http");
  const options = { preset: "chart" };
  const byBytes = await client.unwrap(new Blob([mesh]), options, { server: reads.url });
  const done = await client.unwrap(new URL(from.at("/grid.obj")), options, { server: reads.url, name: "Far away" });
  assert.equal(await done.asset.text(), await byBytes.asset.text());
  assert.equal(done.job.name, "Far away");
  const missing = client.unwrap(new URL(from.at("/none.obj")), options, { server: reads.url });
  await assert.rejects(missing, { code: "source_failed", pointer: "/source" });
  const off = await Server.start(dataDirectory(t));
  const refused = client.unwrap(new URL(from.at("/grid.obj")), options, { server: off.url });
  await assert.rejects(refused, { code: "source_refused" });
});

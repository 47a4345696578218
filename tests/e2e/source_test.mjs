// unwrap with an address in place of a file: the server reads the mesh. UNWRAPD_BIN is the folder of
// both programs.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

import { files } from "../access/source_files.mjs";
import { startServer } from "../contract/server.mjs";

const bin = process.env.UNWRAPD_BIN;

/** Runs unwrap in a folder to its end. */
function unwrap(folder, ...words) {
  return new Promise((resolve) =>
    execFile(join(bin, "unwrap"), words, { cwd: folder }, (error, out, err) => resolve({ code: error?.code ?? 0, out, err })));
}

test("an address has the server read the mesh, with the result of its bytes", async (t) => {
  const folder = mkdtempSync(join(tmpdir(), "unwrap_source_"));
  const server = await startServer(join(bin, "unwrapd"), ["--source-hosts", "localhost", "--source-private", "--source-http"]);
  t.after(async () => {
    await server.stop();
    rmSync(folder, { recursive: true });
  });
  const run = (...words) => unwrap(folder, ...words, "--server", server.base, "--preset", "chart");
  assert.equal((await unwrap(folder, "--sample", "shell.glb")).code, 0);
  const shell = readFileSync(join(folder, "shell.glb"));
  const from = await files(t, ({ url }, response) =>
    url.startsWith("/shell.glb") ? response.writeHead(200).end(shell) : response.writeHead(404).end());
  assert.equal((await run("shell.glb", "-o", "by_bytes.glb")).code, 0);
  assert.equal((await run(from.at("/shell.glb?v=[1]"), "--name", "Shell", "--report", "report.json")).code, 0);
  assert.deepEqual(readFileSync(join(folder, "shell.uv.glb")), readFileSync(join(folder, "by_bytes.glb")));
  assert.equal(from.hits[0].url, "/shell.glb?v=[1]");
  const { jobs } = await (await fetch(`${server.base}/v1/jobs?name=Shell`)).json();
  assert.equal(jobs.length, 1);

  const missing = await run(from.at("/none.glb"));
  assert.equal(missing.code, 1);
  assert.match(missing.err, /404.*source_failed/s);
  const unnamed = await run(from.at("/"));
  assert.equal(unnamed.code, 2);
  assert.match(unnamed.err, /--out/);
  const here = await unwrap(folder, "--local", from.at("/shell.glb"));
  assert.equal(here.code, 2);
  assert.match(here.err, /read by a server/);
  assert.deepEqual(readdirSync(folder).sort(), ["by_bytes.glb", "report.json", "shell.glb", "shell.uv.glb"]);
});

// The guides of docs/: each of their commands runs as it stands, in the order of the text.
// UNWRAPD_BIN is the folder of the programs.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { startServer } from "../contract/server.mjs";

const bin = process.env.UNWRAPD_BIN;
const docs = join(dirname(fileURLToPath(import.meta.url)), "../../docs");
const home = mkdtempSync(join(tmpdir(), "unwrapd_guides_"));
let server;

before(async () => {
  server = await startServer(join(bin, "unwrapd"), ["--source-hosts", "localhost", "--source-private", "--source-http"]);
});

after(async () => {
  await server.stop();
  rmSync(home, { recursive: true });
});

/** A shell with the guide's commands; any that fails ends it. */
function run(commands, folder) {
  const env = { ...process.env, PATH: `${bin}:${process.env.PATH}`, SERVER: server.base };
  const shell = spawn("bash", ["-euo", "pipefail", "-c", commands], { cwd: folder, env, stdio: ["ignore", "pipe", "pipe"] });
  let output = "";
  for (const stream of [shell.stdout, shell.stderr]) stream.on("data", (text) => (output += text));
  return new Promise((resolve) => shell.once("close", (code) => resolve({ code, output })));
}

/** Width and height of a PNG. */
const sizeOf = (path) => {
  const head = readFileSync(path);
  return [head.readUInt32BE(16), head.readUInt32BE(20)];
};

test("the answer that README.md shows, whose pictures are of the same map", async () => {
  const readme = readFileSync(join(docs, "../README.md"), "utf8");
  const text = /^Unwrapd-Report: (\{.*?\})\n```/ms.exec(readme)[1];
  const digits = new Map([...text.matchAll(/"(\w+)":\d+\.(\d+)/g)].map(([, key, decimals]) => [key, decimals.length]));
  const made = await run("unwrap --sample shell.glb", home);
  assert.equal(made.code, 0, made.output);
  const response = await fetch(`${server.base}/v1/unwrap?method=arap`, {
    method: "POST",
    headers: { "Content-Type": "model/gltf-binary" },
    body: readFileSync(join(home, "shell.glb")),
  });
  assert.equal(response.status, 200);
  const rounded = (key, value) => (digits.has(key) ? Number(value.toFixed(digits.get(key))) : value);
  assert.deepEqual(JSON.parse(response.headers.get("unwrapd-report"), rounded), JSON.parse(text));
});

for (const guide of ["guide.md", "methods.md", "cookbook.md"])
  test(`the commands of ${guide}`, async () => {
    const text = readFileSync(join(docs, guide), "utf8");
    const blocks = [...text.matchAll(/^```sh\n(.*?)^```$/gms)].map(([, commands]) => commands);
    assert.ok(blocks.length >= 2, "blocks of commands");
    const folder = mkdtempSync(join(home, "in_"));
    for (const commands of blocks) {
      const { code, output } = await run(commands, folder);
      assert.equal(code, 0, `${commands}\n${output.slice(-2000)}`);
    }
    for (const [, picture] of text.matchAll(/src="([^"]+)"/g)) {
      assert.ok(existsSync(join(docs, picture)), picture);
      assert.deepEqual(sizeOf(join(folder, picture.replace("pictures/", ""))), sizeOf(join(docs, picture)), picture);
    }
  });

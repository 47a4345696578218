// `unwrap` over a folder against a farm: all workers stay busy, and the loss of a serving node, and
// then of all of them for a while, costs no mesh and makes none twice.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { grid } from "../fault/server.mjs";
import { Farm, options, send, sha256Of } from "./nodes.mjs";

const QUERY = "preset=paper&stop.iterations=40&output=obj";

/** A folder of meshes, no two alike. */
function folderOf(farm, count, size) {
  const folder = join(farm.folder, "meshes");
  mkdirSync(folder);
  for (let k = 0; k < count; k++) writeFileSync(join(folder, `${k}.obj`), `# ${k}\n${grid(size + (k % 7))}`);
  return folder;
}

function unwrap(t, addresses, folder, ...words) {
  const flags = ["--preset", "paper", "--stop-iterations", "40", "--output", "obj", "--server", addresses.join(",")];
  const program = join(dirname(process.env.UNWRAPD), "unwrap");
  const child = spawn(program, [folder, "--out", join(folder, "../done"), ...flags, ...words], { stdio: ["ignore", "pipe", "pipe"] });
  t.after(() => child.kill("SIGKILL"));
  const run = { child, out: "", err: "" };
  child.stdout.on("data", (text) => (run.out += text));
  child.stderr.on("data", (text) => (run.err += text));
  run.ended = new Promise((resolve) => child.once("close", resolve));
  return run;
}

const done = (run) => run.err.match(/^\[\d+\/\d+\]/gm)?.length ?? 0;

async function until(run, count) {
  while (done(run) < count) {
    assert.equal(run.child.exitCode, null, run.err);
    await sleep(10);
  }
}

test("a folder keeps all workers busy and outlives the nodes that serve it", options, async (t) => {
  const farm = new Farm(t);
  const fronts = [await farm.start("front-1", 0), await farm.start("front-2", 0)];
  farm.countEnds();
  for (let k = 0; k < 3; k++) await farm.startWorker(`worker-${k}`, "--workers", "2");
  const meshes = 90;
  const folder = folderOf(farm, meshes, 30);
  const run = unwrap(t, fronts.map((node) => node.url), folder);

  // How many wait and run, as the database tells, while most are still to come.
  const seen = { waiting: 0, running: 0 };
  while (done(run) < 15) {
    assert.equal(run.child.exitCode, null, run.err);
    const [waiting, running] = ["queued", "running"].map((state) => Number(farm.query(`SELECT COUNT(*) FROM jobs WHERE state = '${state}'`)));
    seen.waiting = Math.max(seen.waiting, waiting);
    seen.running = Math.max(seen.running, running);
    await sleep(5);
  }
  assert.ok(seen.running >= 5, `only ${seen.running} of 6 workers had a job`);
  assert.ok(seen.waiting >= 2 && seen.waiting <= 16, `${seen.waiting} waited`);

  await fronts[0].end("SIGKILL");
  await until(run, 35);
  await fronts[1].end("SIGKILL");
  await sleep(2000);
  const port = new URL(fronts[1].url).port;
  await farm.start("front-2", 0, "--listen", `127.0.0.1:${port}`);

  assert.equal(await run.ended, 0, run.err);
  assert.match(run.err, /^waiting: The server at /m);
  assert.match(run.out, new RegExp(`^${meshes} done, 0 failed$`, "m"));
  assert.equal(readdirSync(join(folder, "../done")).length, meshes);
  assert.equal(farm.query("SELECT COUNT(*) FROM jobs"), String(meshes));
  assert.equal(farm.query("SELECT COUNT(*) || ' ' || COUNT(DISTINCT id) FROM ends"), `${meshes} ${meshes}`);

  const alone = await farm.start("alone", 1);
  for (const name of [0, 40, 89]) {
    const body = readFileSync(join(folder, `${name}.obj`));
    const fresh = { body, headers: { "Cache-Control": "no-cache" } };
    const answer = await send(alone, `/v1/unwrap?${QUERY}`, fresh);
    const digest = await sha256Of(new Response(readFileSync(join(folder, "../done", `${name}.obj`))));
    assert.equal(await sha256Of(answer), digest, name);
  }
});

test("a first address that nobody has is told at once", options, async (t) => {
  const farm = new Farm(t);
  const run = unwrap(t, ["127.0.0.1:1", "127.0.0.1:2"], folderOf(farm, 3, 3));
  assert.equal(await run.ended, 3);
  assert.match(run.err, /gave no answer/);
});

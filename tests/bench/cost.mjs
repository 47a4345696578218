// What 1,000 assets cost in processor seconds: node cost.mjs UNWRAPD [RUNS [FILE.obj...]]. The assets
// are closed bodies of three sizes, each another one, or files. They are sent to one node as a new user
// sends them, but for the option effort. All of the node's work counts: reading, unwrapping in a process
// of its own, writing, storing.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

process.env.UNWRAPD = process.argv[2];
const RUNS = Number(process.argv[3] ?? 8); // of the smallest size; fewer of larger ones
const FILES = process.argv.slice(4);
const { Server } = await import("../fault/server.mjs");

const SIZES = [1_000, 10_000, 100_000];
const EFFORTS = ["fast", "balanced", "best"];
const UNTIL_NEXT_MS = 80; // the process for the next job has started, and its time counts
const TICKS = Number(execFileSync("getconf", ["CLK_TCK"], { encoding: "utf8" }));

/** An OBJ of a body with about as many faces: a ball with limbs and folds, by the seed. */
function body(faces, seed) {
  const rings = Math.round(Math.sqrt(faces / 4));
  const around = 2 * rings;
  const lines = [];
  const point = (theta, phi) => {
    const limbs = Math.sin(3 * phi + seed) * Math.sin(theta) ** 3 * Math.cos(2 * theta);
    const folds = Math.sin(11 * theta + 7 * Math.sin(2 * phi + seed));
    const r = 1 + 0.6 * limbs + 0.03 * folds;
    lines.push(`v ${r * Math.sin(theta) * Math.cos(phi)} ${r * Math.sin(theta) * Math.sin(phi)} ${r * Math.cos(theta)}`);
  };
  point(0, 0);
  for (let i = 1; i < rings; i++)
    for (let k = 0; k < around; k++) point((Math.PI * i) / rings, (2 * Math.PI * k) / around);
  point(Math.PI, 0);
  const at = (i, k) => (i === 0 ? 1 : i === rings ? 2 + (rings - 1) * around : 2 + (i - 1) * around + (k % around));
  for (let i = 0; i < rings; i++)
    for (let k = 0; k < around; k++) {
      if (i > 0) lines.push(`f ${at(i, k)} ${at(i + 1, k)} ${at(i, k + 1)}`);
      if (i < rings - 1) lines.push(`f ${at(i, k + 1)} ${at(i + 1, k)} ${at(i + 1, k + 1)}`);
    }
  return lines.join("\n") + "\n";
}

/** Processor seconds of a process and of its children that have ended. */
function spent(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1].split(" ");
  return fields.slice(11, 15).reduce((sum, ticks) => sum + Number(ticks), 0) / TICKS;
}

/** [what, how often, an asset by its number] */
const assets = FILES.length
  ? FILES.map((file) => [basename(file), RUNS, (k) => `${readFileSync(file, "utf8")}\n# ${k}\n`])
  : SIZES.map((faces, k) => [`${faces} faces`, Math.max(1, RUNS >> k), (seed) => body(faces, seed)]);

const folder = mkdtempSync(join(tmpdir(), "unwrapd-cost-"));
const server = await Server.start(join(folder, "data"), "--threads", "2", "--max-sync-faces", "1000000");

/** Unwraps one; returns its milliseconds. */
async function unwrap(mesh, effort) {
  const begun = performance.now();
  const headers = { "Content-Type": "model/obj" };
  const answer = await fetch(`${server.url}/v1/unwrap?effort=${effort}`, { method: "POST", headers, body: mesh });
  if (answer.status !== 200) throw new Error(await answer.text());
  await answer.arrayBuffer();
  return performance.now() - begun;
}

try {
  console.log("asset                     effort     runs  CPU s for 1,000  s each, by 2 threads");
  for (const [what, runs, asset] of assets)
    for (const effort of EFFORTS) {
      const before = spent(server.process.pid);
      let ms = 0;
      for (let k = 0; k < runs; k++) {
        ms += await unwrap(asset(k), effort);
        await sleep(UNTIL_NEXT_MS);
      }
      const cost = ((1000 * (spent(server.process.pid) - before)) / runs).toFixed(0);
      const each = (ms / 1000 / runs).toFixed(2);
      console.log(`${what.padEnd(25)} ${effort.padEnd(10)} ${String(runs).padStart(4)} ${cost.padStart(16)} ${each.padStart(22)}`);
    }
} finally {
  server.process.kill("SIGKILL");
  rmSync(folder, { recursive: true, force: true });
}
process.exit(0);

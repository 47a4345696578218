// How much of a large scene's work its helpers take: node scene.mjs UNWRAPD [MESHES [ROUNDS]]. A scene of
// made meshes is unwrapped by default options on a farm of 1, 2 and 4 workers of one thread. Work is
// counted in processor seconds of the process that has most, as this machine may have fewer cores than
// workers; medians of the rounds. The bound follows from the stages of one worker, in which other load of
// the machine counts, too: what is shared divides, the rest stays.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

process.env.UNWRAPD = process.argv[2];
const MESHES = Number(process.argv[3] ?? 300);
const ROUNDS = Number(process.argv[4] ?? 3);
const { Server } = await import("../fault/server.mjs");
const { Postgres } = await import("../postgres/postgres.mjs");
const { freePort } = await import("../fault/free_port.mjs");
const { scene } = await import("./made_scene.mjs");

const SHARED = ["segment", "merge", "factor", "solve", "untangle"];
const median = (all) => all.toSorted((a, b) => a - b)[all.length >> 1];

const folder = mkdtempSync(join(tmpdir(), "unwrapd-scene-"));
const postgres = new Postgres({ sync: false });
const nodes = [];
try {
  const farm = ["--database", postgres.url(), "--blobs", `dir:${join(folder, "shared")}`, "--lease-seconds", "3"];
  const front = await Server.start(join(folder, "front"), "--workers", "0", ...farm);
  const workers = [];
  nodes.push(front);
  const processorSeconds = async (node) => {
    const text = await (await fetch(`http://127.0.0.1:${node.adminPort}/metrics`)).text();
    return Number(text.match(/^unwrapd_job_cpu_seconds_total ([\d.e+-]+)$/m)[1]);
  };
  let runs = 0;
  const run = async () => {
    const body = scene(MESHES, 8, 16, `run ${++runs}`); // a process that stays for its mesh has not ended, and its time does not count yet
    const before = await Promise.all(workers.map(processorSeconds));
    const headers = { "Content-Type": "model/gltf-binary", "Cache-Control": "no-cache" };
    const { id } = await (await fetch(`${front.url}/v1/jobs`, { method: "POST", headers, body })).json();
    let owner;
    const job = await front.until(id, (job) => {
      if (job.state === "running") owner ??= postgres.query(`SELECT node FROM jobs WHERE id = '${id}'`);
      return ["succeeded", "failed", "cancelled"].includes(job.state);
    });
    assert.equal(job.state, "succeeded", JSON.stringify(job));
    await sleep(1000); // helpers end, too
    const after = await Promise.all(workers.map(processorSeconds));
    const spent = after.map((seconds, k) => seconds - before[k]);
    const report = await (await fetch(`${front.url}/v1/jobs/${id}/report`)).json();
    const own = spent[workers.findIndex((node) => node.nodeId === owner)];
    return { own, most: Math.max(...spent), all: spent.reduce((a, b) => a + b), timings: report.timings_ms, faces: report.input.faces };
  };
  let alone, share;
  console.log("workers  own s most s  all s speed-up bound of it");
  for (const count of [1, 2, 4]) {
    while (workers.length < count) {
      const adminPort = await freePort();
      const node = await Server.start(join(folder, `worker-${workers.length}`), "--workers", "1", "--threads", "1", "--admin-listen", `127.0.0.1:${adminPort}`, ...farm);
      const nodeId = readFileSync(join(folder, `worker-${workers.length}`, "node"), "utf8");
      nodes.push(Object.assign(node, { adminPort, nodeId }));
      workers.push(node);
    }
    await sleep(1500); // until all know of each other
    const runs = [];
    for (let round = 0; round < ROUNDS; round++) runs.push(await run());
    const [own, most, all] = ["own", "most", "all"].map((key) => median(runs.map((each) => each[key])));
    if (count === 1) {
      alone = most;
      const shareOf = (names, { queue, total, ...stages }) => names.reduce((sum, name) => sum + stages[name], 0) / (total - queue);
      share = median(runs.map((each) => shareOf(SHARED, each.timings)));
      const percent = (name) => (100 * median(runs.map((each) => shareOf([name], each.timings)))).toFixed(1);
      const names = Object.keys(runs[0].timings).filter((name) => !["queue", "total"].includes(name));
      console.log(`${runs[0].faces} faces; stages in %: ${names.map((name) => `${name} ${percent(name)}`).join(", ")}`);
    }
    const bound = 1 / (1 - share + share / count);
    const cells = [own, most, all, alone / most, bound, alone / most / bound];
    console.log(`${String(count).padEnd(7)}${cells.map((cell) => cell.toFixed(2).padStart(7)).join("")}`);
  }
  console.log(`load ${loadavg().map((load) => load.toFixed(1)).join(" ")}`);
} finally {
  for (const node of nodes) node.process.kill("SIGKILL");
  postgres.remove();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(0);

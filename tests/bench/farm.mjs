// How long news takes between nodes, beside one node alone: node farm.mjs UNWRAPD [JOBS]. Jobs are sent to
// one node, watched at a second and cancelled at a third: from the request until its acceptance and until
// the first event and the first progress of the job, and from a cancel until the last event. Medians and
// 99th percentiles in milliseconds; the farm and the node alone take turns. The load of the machine follows.
import { mkdtempSync, rmSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join } from "node:path";

process.env.UNWRAPD = process.argv[2];
const JOBS = Number(process.argv[3] ?? 100);
const { grid, Server } = await import("../fault/server.mjs");
const { Postgres } = await import("../postgres/postgres.mjs");

const QUICK = "/v1/jobs?preset=chart&stop.iterations=2";
const ENDLESS = "/v1/jobs?preset=paper&stop.iterations=10000";

/** Milliseconds from now until an event of one of these names is seen. */
async function seen(node, id, names, act = () => {}) {
  const answer = await fetch(`${node.url}/v1/jobs/${id}/events`);
  let text = "";
  let since;
  for await (const piece of answer.body) {
    text += Buffer.from(piece);
    if (since === undefined && names.some((name) => text.includes(`event: ${name}\n`))) return performance.now();
    if (act && text.includes("event: iteration\n")) {
      act();
      act = undefined;
    }
  }
  return performance.now();
}

async function send(node, path, body) {
  const answer = await fetch(node.url + path, { method: "POST", headers: { "Content-Type": "model/obj" }, body });
  return (await answer.json()).id;
}

/** A quick job: of each wait its milliseconds. */
async function quick({ front, other }, k) {
  const begun = performance.now();
  const id = await send(front, QUICK, `${grid(8)}# ${k}\n`);
  const submit = performance.now() - begun;
  const [first, progress] = await Promise.all([seen(other, id, ["queued"]), seen(other, id, ["stage", "iteration"])]);
  return { submit, watch: first - begun, progress: progress - begun };
}

async function cancel({ front, other, third }, k) {
  const id = await send(front, ENDLESS, `${grid(60)}# ${k}\n`);
  let begun;
  const ended = await seen(other, id, ["cancelled"], () => {
    begun = performance.now();
    fetch(`${third.url}/v1/jobs/${id}`, { method: "DELETE" });
  });
  return { cancel: ended - begun };
}

const folder = mkdtempSync(join(tmpdir(), "unwrapd-farm-"));
const postgres = new Postgres({ sync: true });
const started = [];
try {
  const start = async (name, ...flags) => {
    const node = await Server.start(join(folder, name), ...flags);
    started.push(node);
    return node;
  };
  const farm = ["--database", postgres.url(), "--blobs", `dir:${join(folder, "shared")}`];
  const alone = await start("alone", "--workers", "1");
  const front = await start("front", "--workers", "0", ...farm);
  const other = await start("other", "--workers", "0", ...farm);
  const third = await start("third", "--workers", "0", ...farm);
  await start("worker", "--workers", "1", ...farm);
  const times = {};
  for (let k = 0; k < JOBS; k++)
    for (const [name, nodes] of [["one node", { front: alone, other: alone, third: alone }], ["farm", { front, other, third }]])
      for (const measure of [quick, cancel])
        for (const [what, milliseconds] of Object.entries(await measure(nodes, k)))
          (times[`${what}, ${name}`] ??= []).push(milliseconds);
  for (const [what, all] of Object.entries(times)) {
    all.sort((a, b) => a - b);
    const at = (share) => all[Math.ceil(share * all.length) - 1].toFixed(1).padStart(7); // the nearest rank
    console.log(`${what.padEnd(20)} median ${at(0.5)}  99 % ${at(0.99)} ms`);
  }
  console.log(`load ${loadavg().map((load) => load.toFixed(1)).join(" ")}`);
} finally {
  for (const node of started) node.process.kill("SIGKILL");
  postgres.remove();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(0);

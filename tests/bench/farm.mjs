// How long news takes between nodes, beside one node alone: node farm.mjs UNWRAPD [JOBS]. From a job's
// acceptance until a reader elsewhere sees its first progress, and from a cancel at one node until the
// last event is seen at another. Medians and 99th percentiles in milliseconds; the two take turns.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
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

async function progress(front, other, k) {
  const begun = performance.now();
  const id = await send(front, QUICK, `${grid(8)}# ${k}\n`);
  return (await seen(other, id, ["stage", "iteration"])) - begun;
}

async function cancel(front, other, k) {
  const id = await send(front, ENDLESS, `${grid(60)}# ${k}\n`);
  let begun;
  const ended = await seen(other, id, ["cancelled"], () => {
    begun = performance.now();
    fetch(`${front.url}/v1/jobs/${id}`, { method: "DELETE" });
  });
  return ended - begun;
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
  await start("worker", "--workers", "1", ...farm);
  const times = {};
  for (let k = 0; k < JOBS; k++)
    for (const [name, first, second] of [["one node", alone, alone], ["farm", front, other]]) {
      for (const [what, measure] of Object.entries({ progress, cancel })) {
        times[`${what}, ${name}`] ??= [];
        times[`${what}, ${name}`].push(await measure(first, second, k));
      }
    }
  for (const [what, all] of Object.entries(times)) {
    all.sort((a, b) => a - b);
    const at = (share) => all[Math.min(all.length - 1, Math.floor(share * all.length))].toFixed(1).padStart(7);
    console.log(`${what.padEnd(20)} median ${at(0.5)}  99 % ${at(0.99)} ms`);
  }
} finally {
  for (const node of started) node.process.kill("SIGKILL");
  postgres.remove();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(0);

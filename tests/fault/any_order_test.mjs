// Whatever a server did before, a job's result is that of a fresh server that keeps nothing: every
// method, start and guarantee, in random orders, with processes of their own and without, warm and
// after a restart. FAULT_ORDERS and FAULT_SEED say how many orders; `./dev fault` runs many.
import assert from "node:assert/strict";
import test from "node:test";

import { dataDirectory, grid, Server } from "./server.mjs";

const ORDERS = Number(process.env.FAULT_ORDERS ?? 1);
const SEED = Number(process.env.FAULT_SEED ?? 1);
const METHODS = ["asap", "arap", "hybrid", "abf", "linabf", "cp", "bff", "ic", "slim"];
const SHORT = "stop.max_iterations=8";
const QUERIES = [
  ...METHODS.map((method) => `method=${method}&guarantee=none`),
  ...["asap", "abf", "arap", "slim"].flatMap((method) =>
    ["flip_free", "bijective"].map((guarantee) => `method=${method}&guarantee=${guarantee}`)),
  ...["lscm", "tutte", "mean_value"].map((initial) => `method=arap&initial=${initial}`),
  ...["1e-6", "0.001", "10"].map((lambda) => `method=hybrid&lambda=${lambda}`),
  "method=asap&pins=spectral",
  "method=asap&boundary=circle",
  "method=arap&max_charts=1",
  "method=arap&repair=virtual_boundary",
].map((query) => `${query}&${SHORT}`);
const MESHES = [grid(5), grid(6)];
const JOBS = MESHES.flatMap((mesh) => QUERIES.map((query) => ({ mesh, query })));

/** Numbers in [0, 1): a linear congruence, its high bits. */
function random(seed) {
  let state = BigInt(seed) + 1n;
  return () => {
    state = (state * 6364136223846793005n + 1442695040888963407n) % 2n ** 64n;
    return Number(state >> 11n) / 2 ** 53;
  };
}

function shuffled(list, seed) {
  const draw = random(seed);
  const order = [...list];
  for (let i = order.length; i > 1; --i) {
    const k = Math.floor(draw() * i);
    [order[i - 1], order[k]] = [order[k], order[i - 1]];
  }
  return order;
}

/** The UVs that a job gives, or the code of its problem. */
async function outcome(server, { mesh, query }) {
  const headers = { "Content-Type": "model/obj", "Cache-Control": "no-cache", Prefer: "wait=120" };
  const answer = await fetch(`${server.url}/v1/jobs?${query}`, { method: "POST", headers, body: mesh });
  const job = await answer.json();
  if (job.state !== "succeeded") return `${answer.status} ${job.problem?.code ?? job.code}`;
  return (await fetch(`${server.url}${job.links.result}`)).text();
}

let expected;
async function expectedOutcomes(t) {
  const server = await Server.start(dataDirectory(t), "--solver-cache-bytes", "0", "--isolate=off");
  const outcomes = new Map();
  for (const job of JOBS) outcomes.set(job, await outcome(server, job));
  await server.end("SIGTERM");
  assert.ok(new Set(outcomes.values()).size > JOBS.length / 2, "most jobs differ from each other");
  return outcomes;
}

for (const isolation of ["--isolate=off", "--isolate=auto"])
  test(`${ORDERS} random orders give what fresh servers give ${isolation}`, async (t) => {
    expected ??= await expectedOutcomes(t);
    for (let seed = SEED; seed < SEED + ORDERS; ++seed) {
      const data = dataDirectory(t);
      const flags = ["--threads", String(1 + (seed % 3)), isolation];
      let server = await Server.start(data, ...flags);
      const order = shuffled(JOBS, seed);
      for (const [k, job] of order.entries()) {
        if (k === Math.floor(order.length / 2)) {
          await server.end("SIGTERM");
          server = await Server.start(data, ...flags);
        }
        assert.ok((await outcome(server, job)) === expected.get(job), `seed ${seed}: ${job.query}`);
      }
      await server.end("SIGTERM");
    }
  });

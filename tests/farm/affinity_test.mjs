// Jobs on a mesh go to the node that keeps its work on it, and wait for no node that is busy or gone.
import assert from "node:assert/strict";
import test from "node:test";

import { freePort } from "../fault/free_port.mjs";
import { grid, QUICK } from "../fault/server.mjs";
import { Farm, options, send } from "./nodes.mjs";

const MESHES = [grid(20), grid(21)];

/** The value of a metric of a node. */
async function metric(node, name, labels) {
  const text = await (await fetch(`http://127.0.0.1:${node.adminPort}/metrics`)).text();
  const line = text.split("\n").find((row) => row.startsWith(`${name}{`) && labels.every((label) => row.includes(label)));
  return Number(line.split(" ").at(-1));
}

test("jobs go where their mesh is known", options, async (t) => {
  const farm = new Farm(t);
  const front = await farm.start("front", 0);
  const nodes = [];
  for (const name of ["one", "two"]) {
    const adminPort = await freePort();
    nodes.push(Object.assign(await farm.start(name, 1, "--isolate", "off", "--admin-listen", `127.0.0.1:${adminPort}`), { adminPort }));
  }
  const submit = async (k) => {
    const path = `/v1/jobs?preset=chart&method=hybrid&lambda=${1 + k / 1000}&${QUICK}`;
    const answer = await send(front, path, { body: MESHES[k % 2] });
    assert.equal(answer.status, 202);
  };
  await Promise.all([0, 1].map(submit)); // each node begins one
  await farm.allEnd();
  const apart = farm.query("SELECT COUNT(DISTINCT node) FROM jobs") === "2";
  await Promise.all(Array.from({ length: 60 }, (_, k) => submit(k + 2)));
  await farm.allEnd();
  const sum = async (name, ...labels) => (await metric(nodes[0], name, labels)) + (await metric(nodes[1], name, labels));
  const hits = await sum("unwrapd_cache_requests_total", 'cache="node"', 'outcome="hit"');
  const misses = await sum("unwrapd_cache_requests_total", 'cache="node"', 'outcome="miss"');
  const made = await sum("unwrapd_cache_requests_total", 'cache="solver"', 'outcome="miss"');
  t.diagnostic(`${hits} hits, ${misses} misses, ${made} factors and maps made; begun ${apart ? "apart" : "at one node"}`);
  assert.ok(hits >= 50 && hits + misses >= 58 && hits + misses <= 60, `${hits} hits, ${misses} misses`);

  await nodes[0].end("SIGKILL"); // what it knew is left to it for a moment, and then begun elsewhere
  const before = Date.now();
  await Promise.all(Array.from({ length: 10 }, (_, k) => submit(k + 100)));
  await farm.allEnd(20);
  t.diagnostic(`10 jobs ended ${Date.now() - before} ms after they were sent to one node of two`);
  assert.equal(farm.query("SELECT COUNT(*) FROM jobs WHERE state <> 'succeeded'"), "0");
});

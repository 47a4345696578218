// The load of the tests that do harm to a farm, and what has to hold after it: no job is lost, none ends
// twice, every result has the bytes of a node alone.
import assert from "node:assert/strict";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, QUICK, Server } from "../fault/server.mjs";
import { send, sha256Of } from "./nodes.mjs";

const SIZES = [2, 3, 4, 5, 6];
const OPTIONS = `preset=chart&${QUICK}`;
const AT_ONCE = 8;
export const FLAGS = ["--isolate=off", "--max-queue", "100000"];

/** What a client of a farm that is being harmed puts up with. */
const PATIENT = {
  ready: async () => {}, // to send a job of this number
  refused: (answer, body) => assert.ok([429, 503].includes(answer.status), JSON.stringify(body)),
  failed: (error) => assert.ok(error instanceof TypeError, error), // the node is gone
};

/** Sends a job under a name until some serving node has taken it. */
async function submit(fronts, k, { refused, failed }) {
  const headers = { "Idempotency-Key": `job-${k}`, "Cache-Control": "no-cache" };
  for (let round = 0; ; round++) {
    const nodes = fronts();
    const node = nodes[(k + round) % nodes.length];
    const answer = await send(node, `/v1/jobs?${OPTIONS}`, { size: SIZES[k % SIZES.length], headers }).catch(failed);
    const body = await answer?.json().catch(failed);
    if (body && [200, 202].includes(answer.status)) return body.id;
    if (body) refused(answer, body);
    await sleep(100);
  }
}

/**
 * Sends so many jobs, some at once, to the nodes that fronts() gives. ids has those that were accepted.
 * client: what differs from a patient one.
 */
export async function submitAll(fronts, jobs, ids, client = {}) {
  const all = { ...PATIENT, ...client };
  let next = 0;
  const sendSome = async () => {
    for (let k = next++; k < jobs; k = next++) {
      await all.ready(k);
      ids[k] = await submit(fronts, k, all);
    }
  };
  await Promise.all(Array.from({ length: AT_ONCE }, sendSome));
}

/** Of the results, in the order of the jobs' sizes. */
export async function digestsOfANodeAlone(t) {
  const alone = await Server.start(dataDirectory(t));
  const digests = [];
  for (const size of SIZES) digests.push(await sha256Of(await send(alone, `/v1/unwrap?${OPTIONS}`, { size })));
  await alone.end("SIGTERM");
  return digests;
}

/** farm.countEnds() came before all jobs; `others` succeeded, too. */
export async function assertAllDone(farm, fronts, ids, expected, others = 0) {
  assert.equal(new Set(ids).size, ids.length);
  assert.equal(farm.query("SELECT row_to_json(jobs) FROM jobs WHERE state NOT IN ('succeeded', 'cancelled')"), "");
  assert.equal(farm.query("SELECT COUNT(*) FROM jobs WHERE state = 'succeeded'"), String(ids.length + others));
  const ended = "SELECT COUNT(DISTINCT id), COUNT(*) - COUNT(DISTINCT id) FROM ends";
  assert.equal(farm.query(ended), `${farm.query("SELECT COUNT(*) FROM jobs")}|0`, "jobs that ended, and how many again");
  assert.equal(farm.query("SELECT COALESCE(SUM(waiting + running), 0) FROM shares"), "0");
  for (const [k, id] of ids.entries()) {
    const answer = await fetch(`${fronts()[k % fronts().length].url}/v1/jobs/${id}/result`);
    assert.equal(answer.status, 200, id);
    assert.equal(await sha256Of(answer), expected[k % SIZES.length], id);
  }
}

// The scaler of docker/kubernetes/farm.yaml on real processes: its query, by a role that may read jobs
// alone, and the formula of KEDA and Kubernetes say how many workers there are; one too many is told to
// go while it works. An hour there is twelve seconds here.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";
import yaml from "js-yaml";

import { Farm, options, send } from "./nodes.mjs";

const YAML = join(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../../docker/kubernetes/farm.yaml");
const objects = yaml.loadAll(readFileSync(YAML, "utf8"));
const { spec } = objects.find((object) => object.kind === "ScaledObject");
const container = objects.find((object) => object.metadata.name === "unwrapd-worker").spec.template.spec.containers[0];
const { query, targetQueryValue } = spec.triggers[0].metadata;
const { stabilizationWindowSeconds, policies: [policy] } = spec.advanced.horizontalPodAutoscalerConfig.behavior.scaleDown;

const FASTER = 300;
const MOST = 4; // this machine is no cluster
const TOLERANCE = 0.1; // Kubernetes'
const LOOK_MS = 100;
const SHORT = "/v1/jobs?preset=paper&stop.iterations=1000";
const LONG = "/v1/jobs?preset=paper&stop.iterations=10000";

/** The flags of the pod that do not name its mounts. */
const flags = container.args.filter((flag) => /--(workers|threads|drain-seconds)=/.test(flag)).flatMap((flag) => flag.split("="));

/** What a HorizontalPodAutoscaler makes of an external metric: how many pods there shall be. */
class Scaler {
  wishes = [];
  removals = [];

  wanted(metric, current, now = Date.now()) {
    const ratio = metric / (Number(targetQueryValue) * current);
    const plain = Math.abs(ratio - 1) <= TOLERANCE ? current : Math.ceil(metric / Number(targetQueryValue));
    const wish = Math.min(Math.max(plain, spec.minReplicaCount), Math.min(spec.maxReplicaCount, MOST));
    const since = now - (1000 * stabilizationWindowSeconds) / FASTER;
    this.wishes = [...this.wishes.filter((one) => one.at > since), { at: now, wish }];
    if (wish >= current) return wish;
    this.removals = this.removals.filter((at) => at > now - (1000 * policy.periodSeconds) / FASTER);
    const least = Math.floor((current + this.removals.length) * (1 - policy.value / 100));
    const calm = Math.min(current, Math.max(least, ...this.wishes.map((one) => one.wish)));
    this.removals.push(...new Array(current - calm).fill(now));
    return calm;
  }
}

/** Workers as pods: some are told to go, and live on until they have. */
class Workers {
  all = [];
  leaving = [];
  wereBusy = 0;

  constructor(farm) {
    this.farm = farm;
  }

  async become(count) {
    while (this.all.length < count) {
      const name = `worker-${this.all.length + this.leaving.length}`;
      this.all.push(await this.farm.startWorker(name, ...flags));
    }
    const busy = this.farm.query("SELECT node FROM jobs WHERE state = 'running'").split("\n");
    while (this.all.length > count) {
      const at = Math.max(0, this.all.findIndex((node) => busy.includes(node.id))); // the worst choice
      const [node] = this.all.splice(at, 1);
      if (busy.includes(node.id)) this.wereBusy++;
      this.leaving.push(node.end("SIGTERM"));
    }
  }
}

test("workers are added while jobs wait, and go when they have ended what they run", options, async (t) => {
  assert.equal(policy.type, "Percent");
  const farm = new Farm(t);
  const front = await farm.start("front", 0);
  farm.countEnds();
  farm.query("CREATE ROLE scaler; GRANT SELECT ON jobs TO scaler");
  const scaler = new Scaler();
  const workers = new Workers(farm);
  await workers.become(spec.minReplicaCount);
  for (let k = 0; k < 12; k++) assert.equal((await send(front, SHORT, { size: 40 + k })).status, 202);
  for (const size of [64, 65]) assert.equal((await send(front, LONG, { size })).status, 202);

  const counts = [];
  for (const giveUp = Date.now() + 120_000; ; await sleep(LOOK_MS)) {
    const metric = Number(farm.query(`SET ROLE scaler; ${query}`));
    const left = Number(farm.query("SELECT SUM(waiting + running) FROM shares"));
    const count = scaler.wanted(metric, workers.all.length);
    assert.ok(count >= Math.min(left, MOST), `${count} workers for ${left} jobs`);
    await workers.become(count);
    if (count !== counts.at(-1)) counts.push(count);
    if (metric === 0 && count === spec.minReplicaCount) break;
    assert.ok(Date.now() < giveUp, `${metric} jobs are left`);
  }
  const ends = await Promise.all(workers.leaving);
  t.diagnostic(`workers: ${counts.join(", ")}; ${workers.wereBusy} were told to go at work`);
  assert.equal(Math.max(...counts), MOST);
  assert.ok(workers.wereBusy > 0);
  for (const end of ends) assert.deepEqual(end, [0, null]);
  assert.equal(farm.query("SELECT COUNT(*), MIN(state), MAX(state), MAX(attempt) FROM jobs"), "14|succeeded|succeeded|1");
  assert.equal(farm.query("SELECT COUNT(*), COUNT(DISTINCT id) FROM ends"), "14|14");
});

test("a job that outlives the drain of its worker is given back and ends elsewhere", options, async (t) => {
  const farm = new Farm(t);
  const front = await farm.start("front", 0);
  farm.countEnds();
  const leaving = await farm.startWorker("leaving", "--drain-seconds", "0");
  const { id } = await (await send(front, LONG, { size: 60 })).json();
  await front.iterates(id);
  const ended = leaving.end("SIGTERM");
  const staying = await farm.startWorker("staying");
  assert.deepEqual(await ended, [0, null]);
  await farm.allEnd(60);
  assert.equal(farm.query("SELECT state, attempt, crashes, node FROM jobs"), `succeeded|2|0|${staying.id}`);
  assert.equal(farm.query("SELECT COUNT(*) FROM ends"), "1");
});

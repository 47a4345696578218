// The alerts and the dashboard of docker/ by a real Prometheus that asks real nodes: every query is
// understood, finds what it names and has an answer, and alerts are seen when the database is away.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";
import yaml from "js-yaml";

import { freePort } from "../fault/free_port.mjs";
import { QUICK } from "../fault/server.mjs";
import { Farm, isInstalled, options, send } from "./nodes.mjs";

const ROOT = join(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../..");
const DOCKER = join(ROOT, "docker");
const read = (path) => readFileSync(join(ROOT, path), "utf8");
const WINDOW = "1m";
const SCRAPES = 3; // that a rate needs, and one to spare

const NO_PROMETHEUS = "Prometheus is not installed (Debian package prometheus)";
const skip = options.skip || (isInstalled("prometheus") && isInstalled("promtool") ? false : NO_PROMETHEUS);
const promtool = (...args) => execFileSync("promtool", args, { cwd: join(DOCKER, "prometheus"), encoding: "utf8", stdio: "pipe" });

const alerts = () => yaml.load(read("docker/prometheus/alerts.yaml")).groups.flatMap((group) => group.rules);
const dashboard = () => JSON.parse(read("docker/grafana/unwrapd.json"));
const targets = () => dashboard().panels.flatMap((panel) => panel.targets ?? []);
const shown = (target) => target.expr.replaceAll("$__rate_interval", WINDOW).replaceAll("$__range", WINDOW);

/** A Prometheus with the configuration of docker/, but for whom it asks, and how often. */
async function prometheus(t, folder, ports) {
  const config = yaml.load(read("docker/prometheus/prometheus.yaml"));
  config.global = { scrape_interval: "1s", evaluation_interval: "1s" };
  config.rule_files = config.rule_files.map((file) => join(DOCKER, "prometheus", file));
  delete config.scrape_configs[0].dns_sd_configs;
  config.scrape_configs[0].static_configs = [{ targets: ports.map((port) => `127.0.0.1:${port}`) }];
  const file = join(folder, "prometheus.yaml");
  writeFileSync(file, yaml.dump(config));
  const port = await freePort();
  const flags = [`--config.file=${file}`, `--storage.tsdb.path=${join(folder, "tsdb")}`, `--web.listen-address=127.0.0.1:${port}`];
  const server = spawn("prometheus", [...flags, "--log.level=error"], { stdio: "ignore" });
  t.after(() => server.kill("SIGKILL"));
  const ask = async (expr) => {
    const answer = await fetch(`http://127.0.0.1:${port}/api/v1/query?query=${encodeURIComponent(expr)}`);
    const { status, data, error } = await answer.json();
    assert.equal(status, "success", `${expr}: ${error}`);
    return data.result;
  };
  const until = async (expr, found) => {
    for (const giveUp = Date.now() + 30_000; ; await sleep(200)) {
      const result = await ask(expr).catch((error) => (error instanceof TypeError ? [] : Promise.reject(error)));
      if (found(result)) return result;
      assert.ok(Date.now() < giveUp, `${expr} is ${JSON.stringify(result)}`);
    }
  };
  return { ask, until };
}

/** Each metric that a query names, with the matchers of its labels. */
function* selectorsOf(expr) {
  for (const [, name, inside = ""] of expr.matchAll(/\b(\w+_\w+)\b(?!\s*\()(?:\{([^}]*)\})?/g)) {
    if (inside === "" && !/^(unwrapd|process)_/.test(name)) continue; // a function
    yield { name, labels: [...inside.matchAll(/(\w+)\s*(?:=~|!~|!=|=)/g)].map((found) => found[1]), selector: `${name}{${inside}}` };
  }
}

const groupedBy = (expr) => [...expr.matchAll(/\b(?:by|on) \(([^)]*)\)/g)].flatMap(([, list]) => list.split(",").map((label) => label.trim()));

test("the alerts fire in the farms that they are for, and in no other", { skip }, () => {
  promtool("check", "rules", "alerts.yaml");
  promtool("check", "config", "prometheus.yaml");
  promtool("test", "rules", "alerts_test.yaml");
  const tested = read("docker/prometheus/alerts_test.yaml");
  const guide = read("docs/farm.md");
  for (const { alert, annotations } of alerts()) {
    assert.match(tested, new RegExp(`exp_samples:.*alertname="${alert}"|- \\{ labels: .*alertname="${alert}"`), alert);
    assert.match(annotations.summary, /\. \S|; \S/, `${alert} says what to do`);
    assert.ok(guide.includes(`\`${alert}\``), `docs/farm.md does not name ${alert}`);
  }
});

test("panels have numbers of their own and do not overlap", () => {
  const { panels } = dashboard();
  assert.equal(new Set(panels.map((panel) => panel.id)).size, panels.length);
  const taken = new Set();
  for (const { title, gridPos } of panels)
    for (let x = gridPos.x; x < gridPos.x + gridPos.w; x++)
      for (let y = gridPos.y; y < gridPos.y + gridPos.h; y++) {
        assert.ok(x < 24 && !taken.has(`${x} ${y}`), title);
        taken.add(`${x} ${y}`);
      }
});

test("every query of the dashboard and of the alerts names what nodes tell", { skip }, async (t) => {
  const farm = new Farm(t);
  const ports = [await freePort(), await freePort()];
  const front = await farm.start("front", 0, "--admin-listen", `127.0.0.1:${ports[0]}`);
  await farm.startWorker("worker", "--admin-listen", `127.0.0.1:${ports[1]}`);
  const { ask, until } = await prometheus(t, farm.folder, ports);
  const readiness = () => Promise.all(ports.map((port) => fetch(`http://127.0.0.1:${port}/readyz`)));

  await readiness();
  for (const size of [3, 4]) assert.equal((await send(front, `/v1/unwrap?preset=chart&${QUICK}`, { size })).status, 200);
  assert.equal((await send(front, "/v1/jobs?method=none")).status, 422);
  const bad = await (await send(front, "/v1/jobs", { body: "v 1 2\nf 1 2 3\n" })).json();
  await front.finished(bad.id);
  const known = `count_over_time(unwrapd_job_errors_total[${WINDOW}])`;
  await until(known, (result) => result.some(({ value }) => Number(value[1]) >= SCRAPES));

  for (const target of targets()) {
    const result = await ask(shown(target));
    assert.ok(result.length > 0, `${target.expr} finds nothing`);
    for (const [, label] of target.legendFormat.matchAll(/\{\{(\w+)\}\}/g))
      for (const { metric } of result) assert.ok(metric[label], `${target.expr} has no ${label}`);
  }
  assert.deepEqual(await ask('ALERTS{alertstate="firing"}'), []);

  farm.postgres.kill();
  for (let k = 0; k < 2; k++) {
    const probed = await readiness();
    assert.deepEqual(probed.map(({ status }) => status), [503, 503]);
    assert.equal((await fetch(`${front.url}/v1/jobs`)).status, 503);
    await sleep(1500); // scraped: a rate needs a first value
  }
  await until('ALERTS{alertname="UnwrapdStoreFails"}', (result) => result.length === 2);

  const codes = read("api/openapi.yaml");
  for (const { alert, expr } of alerts()) {
    for (const { name, labels, selector } of selectorsOf(expr)) {
      assert.notDeepEqual(await ask(`{__name__="${name}"}`), [], `${alert}: no node tells ${name}`);
      for (const label of labels)
        assert.notDeepEqual(await ask(`${name}{${label}!=""}`), [], `${alert}: ${name} has no label ${label}`);
      const code = /code=~?"([\w|]+)"/.exec(selector)?.[1].split("|") ?? [];
      for (const one of code) assert.match(codes, new RegExp(`^        - ${one}$`, "m"), `${alert}: there is no code ${one}`);
      if (code.length === 0) assert.notDeepEqual(await ask(selector), [], `${alert}: ${selector} finds nothing`);
    }
    const series = await ask('{__name__=~"unwrapd_.*|process_.*"}');
    for (const label of groupedBy(expr)) assert.ok(series.some(({ metric }) => metric[label]), `${alert}: no ${label}`);
  }
});

// The proxy and the secret of docker/compose.farm.yaml with real nodes: events pass at once, a node
// that dies is passed by, and a password in a file opens the database.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";
import yaml from "js-yaml";

import { freePort } from "../fault/free_port.mjs";
import { dataDirectory, ENDLESS, QUICK } from "../fault/server.mjs";
import { Postgres } from "../postgres/postgres.mjs";
import { Farm, isInstalled, options, send } from "./nodes.mjs";

const DOCKER = join(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../../docker");
const read = (path) => readFileSync(join(DOCKER, path), "utf8");
const NO_NGINX = "nginx is not installed (Debian package nginx-light)";

/** The nginx of the file, but for its addresses and its scratch files. */
async function proxyBefore(t, nodes, folder) {
  const port = await freePort();
  let next = 0;
  const config = read("nginx.farm.conf")
    .replace(/listen \d+;/, `listen 127.0.0.1:${port};`)
    .replace(/server [\d.]+:\d+;/g, () => `server ${new URL(nodes[next++].url).host};`)
    .replaceAll("/tmp/", `${folder}/`);
  assert.equal(next, nodes.length);
  mkdirSync(folder);
  writeFileSync(join(folder, "nginx.conf"), config);
  const server = spawn("nginx", ["-c", join(folder, "nginx.conf"), "-g", "daemon off; user root;"], { stdio: "ignore" });
  t.after(() => server.kill("SIGTERM"));
  const url = `http://127.0.0.1:${port}`;
  for (const giveUp = Date.now() + 10_000; !(await fetch(url).then(() => true, () => false)); await sleep(20))
    assert.ok(Date.now() < giveUp, "nginx does not answer");
  return { url };
}

test("events pass the proxy at once, and requests a node that died", { skip: options.skip || !isInstalled("nginx", "-v") && NO_NGINX }, async (t) => {
  const farm = new Farm(t);
  const fronts = [await farm.start("front-1", 0), await farm.start("front-2", 0)];
  await farm.startWorker("worker", "--workers", "1");
  const proxy = await proxyBefore(t, fronts, join(farm.folder, "nginx"));
  for (let k = 0; k < 4; k++) assert.equal((await send(proxy, `/v1/unwrap?preset=chart&${QUICK}`, { size: 3 + k })).status, 200);

  const { id } = await (await send(proxy, `/v1/jobs?preset=paper&${ENDLESS[0]}`, { size: ENDLESS[1] })).json();
  const events = await fetch(`${proxy.url}/v1/jobs/${id}/events`);
  let text = "";
  let cancelled; // once: to delete a job that has ended is to remove it
  for await (const piece of events.body) {
    text += Buffer.from(piece);
    if (/^event: iteration$/m.test(text)) cancelled ??= await fetch(`${proxy.url}/v1/jobs/${id}`, { method: "DELETE" });
  }
  assert.match(text, /^event: cancelled$/m);

  await fronts[0].end("SIGKILL");
  for (let k = 0; k < 10; k++) {
    assert.equal((await fetch(`${proxy.url}/v1/jobs/${id}`)).status, 200);
    assert.equal((await send(proxy, `/v1/jobs?preset=chart&${QUICK}`, { size: 10 + k })).status, 202);
  }
});

test("the nodes of the compose file read the database's password from a file", options, (t) => {
  const postgres = new Postgres({ sync: false });
  t.after(() => postgres.remove());
  const compose = read("compose.farm.yaml");
  const [, format] = /printf '([^']+)'/.exec(compose);
  const { UNWRAPD_DATABASE } = yaml.load(compose).services.worker.environment;
  const service = format.replaceAll("\\n", "\n").replace("%s", "anything");
  assert.match(service, /^host=postgres\ndbname=unwrapd\nuser=unwrapd\npassword=anything$/m);
  const data = dataDirectory(t);
  const PGSERVICEFILE = join(data, "postgres.service");
  writeFileSync(PGSERVICEFILE, service.replace("host=postgres", `host=${postgres.folder}`).replaceAll("=unwrapd", "=postgres"));
  const env = { ...process.env, UNWRAPD_DATABASE, PGSERVICEFILE };
  execFileSync(process.env.UNWRAPD, ["keys", "add", "--data", data, "--name", "from-a-file"], { env });
  assert.equal(postgres.query("SELECT name FROM keys"), "from-a-file");
});

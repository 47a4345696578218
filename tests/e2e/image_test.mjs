// The image as it is meant to run: another user, nothing writable but the volume, no capability,
// little memory, a key in a mounted file. A job is stopped by SIGTERM in its middle and ends well at
// the next start.
// Podman plays the Kubernetes objects, too: of one node, and of a farm on a real PostgreSQL.
// UNWRAPD_ENGINE names docker or podman, UNWRAPD_IMAGE the image.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { randomBytes } from "node:crypto";
import { chmodSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import yaml from "js-yaml";

import { freePort } from "../fault/free_port.mjs";
import { grid } from "../fault/server.mjs";
import { isInstalled, NOT_INSTALLED, Postgres } from "../postgres/postgres.mjs";

const { UNWRAPD_ENGINE: engine, UNWRAPD_IMAGE: image } = process.env;
const name = `unwrapd-test-${randomBytes(4).toString("hex")}`;
const MAX_ADDED_MB = 150;
// Podman's own health checks are timers of systemd, and its limits may be above a sandbox's: without
// systemd neither can be had, and the check is run by hand below all the same.
const bare = engine === "podman" && !existsSync("/run/systemd/system");
const scratch = mkdtempSync(join(tmpdir(), "unwrapd_image_"));
if (bare) {
  process.env.CONTAINERS_CONF = join(scratch, "containers.conf");
  writeFileSync(process.env.CONTAINERS_CONF, '[containers]\ndefault_ulimits = ["nofile=1024:1024", "nproc=1024:1024"]\n');
}
const sandbox = bare ? ["--no-healthcheck"] : [];
const key = randomBytes(32).toString("hex"); // as docker/compose.yaml has one made
const keyFile = join(scratch, "key");
writeFileSync(keyFile, `${key}\n`, { mode: 0o444 });
chmodSync(scratch, 0o755);
const holder = { Authorization: `Bearer ${key}` };

const run = (...args) => execFileSync(engine, args, { encoding: "utf8" }).trim();

/** "8.31 MB", "512kB" */
function megabytes(text) {
  const [, number, unit] = /^([\d.]+) ?([kMG]?)B$/.exec(text);
  return Number(number) * { "": 1e-6, k: 1e-3, M: 1, G: 1e3 }[unit];
}

let url, admin;
const job = async (id) => (await fetch(`${url}/v1/jobs/${id}`, { headers: holder })).json();

async function until(what, condition) {
  for (const giveUp = Date.now() + 180_000; Date.now() < giveUp; await sleep(20)) {
    const found = await condition().catch(() => undefined);
    if (found) return found;
  }
  const logs = spawnSync(engine, ["logs", name], { encoding: "utf8" });
  assert.fail(`${what}: awaited in vain\n${logs.stdout}${logs.stderr}`);
}

async function submit(query, size) {
  const answer = await fetch(`${url}/v1/jobs?${query}`, {
    method: "POST",
    headers: { ...holder, "Content-Type": "model/obj" },
    body: grid(size),
  });
  assert.equal(answer.status, 202, await answer.clone().text());
  return (await answer.json()).id;
}

after(() => rmSync(scratch, { recursive: true }));

test("the image is small, labelled, and of a user who is not root", () => {
  const [told] = JSON.parse(run("inspect", "--type", "image", image));
  assert.equal(told.Config.User, "10001:10001");
  assert.match(told.Config.Labels["org.opencontainers.image.version"], /^\d+\.\d+\.\d+$/);
  assert.deepEqual(told.Config.Healthcheck?.Test ?? told.Healthcheck?.Test, ["CMD", "unwrapd", "--healthcheck"]);
  const layers = run("history", "--format", "{{.Size}}", image).split("\n").map(megabytes).filter((size) => size > 0);
  const added = layers.slice(0, -1).reduce((sum, size) => sum + size, 0); // the last is Debian's
  console.log(`the image adds ${added.toFixed(1)} MB to its base`);
  assert.ok(added <= MAX_ADDED_MB, `${added} MB over the base`);
});

/** Starts the image as it is meant to run, with more flags, and without a shell (/usr/bin is empty). */
async function start(...flags) {
  const port = await freePort(2);
  [url, admin] = [`http://127.0.0.1:${port}`, `http://127.0.0.1:${port + 1}`];
  run("run", "--detach", "--name", name, "--network", "host", "--user", "10001:10001", "--read-only",
    "--cap-drop", "ALL", "--security-opt", "no-new-privileges", "--memory", "512m", "--volume", `${name}:/data`,
    "--tmpfs", "/usr/bin", "--volume", `${keyFile}:/run/secrets/key:ro`, "--env", "UNWRAPD_KEY_FILE=/run/secrets/key", ...sandbox,
    "--env", `UNWRAPD_LISTEN=127.0.0.1:${port}`, image, "--drain-seconds", "0", "--workers", "1", ...flags);
  await until("the server", async () => (await fetch(`${admin}/readyz`)).ok);
}

function remove() {
  run("rm", "--force", name);
  run("volume", "rm", "--force", name);
}

for (const flags of [["--isolate=off"], ["--isolate"]])
  test(`hardened, it serves, drains at SIGTERM, and goes on where it was ${flags}`, async (t) => {
    t.after(remove);
    await start(...flags);
    await unwrapsAndGoesOn();
  });

async function unwrapsAndGoesOn() {
  assert.equal(run("exec", name, "unwrapd", "--healthcheck"), "");
  assert.equal((await fetch(`${url}/v1/jobs`)).status, 401);

  const small = await submit("method=arap", 20);
  await until("a small job", async () => (await job(small)).state === "succeeded");
  const obj = await (await fetch(`${url}/v1/jobs/${small}/result`, { headers: holder })).text();
  const picture = await fetch(`${url}/v1/jobs/${small}/preview.png?size=64`, { headers: holder });
  assert.equal(picture.headers.get("content-type"), "image/png");
  assert.equal(obj.match(/^vt /gm).length, 21 * 21);

  const long = await submit("stop.iterations=10000", 100);
  await until("an iteration", async () => (await job(long)).progress?.iteration > 0);
  run("stop", "--time", "30", name);
  const [stopped] = JSON.parse(run("inspect", "--type", "container", name));
  assert.equal(stopped.State.ExitCode, 0, run("logs", name));
  run("start", name);
  await until("the next start", async () => (await fetch(`${admin}/readyz`)).ok);
  const ended = await until("the job", async () => {
    const told = await job(long);
    return ["succeeded", "failed", "cancelled"].includes(told.state) && told;
  });
  assert.equal(ended.state, "succeeded", JSON.stringify(ended));
  assert.equal(ended.attempt, 2);
  assert.equal((await job(small)).state, "succeeded");
  run("stop", "--time", "30", name);
}

/** Where it was not played, that is the error to tell. */
function unplay(file, volumes, secrets) {
  const named = (all) => all.map((one) => `${name}-${one}`);
  spawnSync(engine, ["play", "kube", "--down", file]);
  spawnSync(engine, ["volume", "rm", "--force", ...named(volumes)]);
  spawnSync(engine, ["secret", "rm", ...named(secrets)]);
}

test("podman plays the Kubernetes objects", async (context) => {
  if (engine !== "podman") return context.skip("only podman can play them");
  const file = join(scratch, "kube.yaml");
  const objects = readFileSync(new URL("../../docker/kubernetes/unwrapd.yaml", import.meta.url), "utf8");
  const secret = `apiVersion: v1\nkind: Secret\nmetadata: { name: unwrapd-key }\ndata: { key: ${btoa(key)} }\n---\n`;
  const here = { "unwrapd-data": `${name}-data`, "unwrapd-config": `${name}-config`, "name: unwrapd\n": `name: ${name}\n`,
    "unwrapd-key": `${name}-key` };
  writeFileSync(file, Object.entries(here).reduce((text, [from, to]) => text.replaceAll(from, to), secret + objects)
    .replace("image: unwrapd:latest", `image: ${image}`));
  try {
    run("play", "kube", file);
    await until("the pod", async () => run("exec", `${name}-pod-0-${name}`, "unwrapd", "--healthcheck",
      "--admin-listen", "127.0.0.1:8081") === "");
  } finally {
    unplay(file, ["data", "config", "key"], ["key"]);
  }
});

const NETWORK = "podman-default-kube-network";

/**
 * What podman 4.3 plays of the farm, named for this test. It shares volumes that pods have for themselves,
 * takes the ports of a container from the host, and leaves files of secrets in base64.
 */
function playedFarm(text) {
  const objects = yaml.loadAll(text.replaceAll("unwrapd-", `${name}-`).replaceAll("name: unwrapd-farm", `name: ${name}-farm`))
    .filter(({ kind }) => ["PersistentVolumeClaim", "ConfigMap", "Deployment"].includes(kind));
  for (const { kind, metadata, spec } of objects) {
    if (kind !== "Deployment") continue;
    spec.replicas = 1;
    const [container] = spec.template.spec.containers;
    container.image = image;
    delete container.ports;
    for (const volume of [...spec.template.spec.volumes, ...container.volumeMounts])
      if (volume.name === "data") volume.name = `${metadata.name}-data`;
  }
  return objects;
}

test("podman plays a farm, whose worker ends the jobs that another node takes in", async (t) => {
  if (engine !== "podman") return t.skip("only podman can play it");
  if (!isInstalled()) return t.skip(NOT_INSTALLED);
  const port = await freePort(2);
  const postgres = new Postgres({ sync: false, settings: { listen_addresses: "*", port } });
  const objects = playedFarm(readFileSync(new URL("../../docker/kubernetes/farm.yaml", import.meta.url), "utf8"));
  const file = join(scratch, "farm.yaml");
  t.after(() => {
    unplay(file, ["blobs", "farm", "key", "serve-data", "worker-data"], ["key", "database"]);
    postgres.remove();
  });
  const [{ subnets: [{ gateway }] }] = JSON.parse(run("network", "inspect", NETWORK));
  const database = join(scratch, "database.json"); // of a secret that sets variables podman reads JSON, not YAML
  writeFileSync(database, JSON.stringify({ url: btoa(`postgres://postgres@${gateway}:${port}/postgres`) }));
  run("secret", "create", `${name}-database`, database);
  const secret = { apiVersion: "v1", kind: "Secret", metadata: { name: `${name}-key` }, data: { key: btoa(key) } };
  writeFileSync(file, [secret, ...objects].map((object) => yaml.dump(object)).join("---\n"));
  run("play", "kube", file);

  const pod = JSON.parse(run("pod", "inspect", `${name}-serve-pod-0`));
  const [infra] = JSON.parse(run("inspect", pod.InfraContainerID));
  url = `http://${infra.NetworkSettings.Networks[NETWORK].IPAddress}:8080`;
  holder.Authorization = `Bearer ${btoa(key)}`;
  await until("the farm", async () => (await fetch(url.replace("8080", "8081/readyz"))).ok);
  const id = await submit("", 20);
  await until("a job of the worker's", async () => (await job(id)).state === "succeeded");
  const obj = await (await fetch(`${url}/v1/jobs/${id}/result`, { headers: holder })).text();
  assert.equal(obj.match(/^vt /gm).length, 21 * 21);
});

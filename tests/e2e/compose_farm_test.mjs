// docker/compose.farm.yaml is right: in itself, beside the files that it mounts, and in the eyes of
// the server whose options it sets. UNWRAPD names the binary.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import yaml from "js-yaml";

import { accepted, folder, image, isIgnored, LONGEST_END, read, valueOf } from "./deployment.mjs";

const { services, secrets, volumes, networks } = yaml.load(read("compose.farm.yaml"));
const nodes = Object.entries(services).filter(([, service]) => service.image === "unwrapd:latest");
const serving = nodes.filter(([name]) => name.startsWith("serve"));
const told = ({ command = [], environment }) => accepted(command, { ...image, ...environment });
const address = (service) => service.networks.farm.ipv4_address;

test("there are two nodes that serve and three that only work, all on one store", () => {
  assert.deepEqual(nodes.map(([name]) => name), ["serve-1", "serve-2", "worker"]);
  for (const [, service] of serving) assert.equal(valueOf(told(service), "workers"), 0);
  assert.deepEqual(services.worker.command, ["worker"]);
  assert.equal(services.worker.deploy.replicas, 3);
  const [first, ...others] = nodes.map(([, service]) => told(service));
  for (const option of ["blobs", "max-disk-bytes", "keep-seconds", "max-stored-jobs", "lease-seconds", "webhook-hosts"])
    for (const other of others) assert.deepEqual(valueOf(other, option), valueOf(first, option), option);
  for (const one of [first, ...others]) assert.match(one, /^database = "\*+" +# from UNWRAPD_DATABASE$/m);
});

test("nodes are given time to end", () => {
  for (const [name, service] of nodes)
    assert.ok(parseInt(service.stop_grace_period) > valueOf(told(service), "drain-seconds") + LONGEST_END, name);
});

test("every container is hardened, bounded and of a version, and reached from this machine alone", () => {
  for (const [name, service] of Object.entries(services)) {
    assert.equal(service.read_only, true, name);
    assert.deepEqual(service.cap_drop, ["ALL"], name);
    assert.deepEqual(service.security_opt, ["no-new-privileges:true"], name);
    assert.match(service.user, /^[1-9]\d*:\d+$/, name);
    assert.match(service.mem_limit, /^\d+[mg]$/, name);
    assert.match(service.image, /^unwrapd:latest$|:v?\d+(\.\d+)*$/, name);
    for (const port of service.ports ?? []) assert.match(port, /^127\.0\.0\.1:/, name);
  }
  assert.deepEqual(nodes.flatMap(([, service]) => service.ports ?? []), []);
});

test("secrets are files that are not committed, where their readers look", () => {
  for (const [name, { file }] of Object.entries(secrets)) isIgnored(file, name);
  for (const [name, service] of Object.entries(services)) {
    for (const secret of service.secrets ?? []) assert.ok(secrets[secret], secret);
    const paths = Object.values(service.environment ?? {}).filter((value) => String(value).startsWith("/run/secrets/"));
    assert.deepEqual(paths.sort(), (service.secrets ?? []).map((secret) => `/run/secrets/${secret}`).sort(), name);
  }
});

test("what is mounted is there, and the nodes' volume is their user's from the start", () => {
  for (const service of Object.values(services))
    for (const mount of service.volumes ?? []) {
      const [source] = mount.split(":");
      assert.ok(source.startsWith("./") ? existsSync(join(folder, source)) : source in volumes, mount);
    }
  const blobs = valueOf(told(services.worker), "blobs").replace("dir:", "");
  for (const [, service] of nodes) assert.deepEqual(service.volumes, [`blobs:${blobs}`]);
  assert.match(read("Dockerfile"), new RegExp(`install -d -o 10001 -g 10001 -m 0700 /data ${blobs}\n`));
});

test("the proxy passes to all nodes that serve, and they trust it alone", () => {
  const proxy = read("nginx.farm.conf");
  const [, port] = valueOf(told(services["serve-1"]), "listen").split(":");
  const upstreams = [...proxy.matchAll(/^ +server ([\d.]+:\d+);$/gm)].map(([, one]) => one);
  assert.deepEqual(upstreams, serving.map(([, service]) => `${address(service)}:${port}`));
  const network = networks.farm.ipam.config[0].subnet.replace(/0\/24$/, "");
  for (const service of [services.proxy, ...serving.map(([, one]) => one)]) assert.ok(address(service).startsWith(network));
  for (const [, service] of nodes) assert.deepEqual(valueOf(told(service), "trusted-proxies"), [address(services.proxy)]);
  const [listens] = services.proxy.ports[0].split(":").slice(-1);
  assert.match(proxy, new RegExp(`^ +listen ${listens};$`, "m"));
  assert.ok(services.proxy.healthcheck.test.includes(`http://127.0.0.1:${listens}/readyz`));
});

test("the proxy of a farm passes requests on as that of one node does", () => {
  const location = (name) => /location \/ \{([^}]*)\}/.exec(read(name))[1].trim().split("\n").map((line) => line.trim());
  for (const line of location("nginx.conf")) assert.ok(location("nginx.farm.conf").includes(line), line);
});

test("Prometheus asks the admin port of every node, and Grafana finds it and the dashboard", () => {
  const [{ dns_sd_configs: [asked] }] = yaml.load(read("prometheus/prometheus.yaml")).scrape_configs;
  assert.deepEqual(asked.names, nodes.map(([name]) => name));
  for (const [, service] of nodes) assert.equal(valueOf(told(service), "admin-listen"), `0.0.0.0:${asked.port}`);
  const [source] = yaml.load(read("grafana/provisioning/datasources/prometheus.yaml")).datasources;
  const [, port] = services.prometheus.ports[0].split(":").slice(1);
  assert.equal(source.url, `http://prometheus:${port}`);
  const [{ options: { path } }] = yaml.load(read("grafana/provisioning/dashboards/unwrapd.yaml")).providers;
  const { environment, volumes: mounts } = services.grafana;
  assert.equal(environment.GF_DASHBOARDS_DEFAULT_HOME_DASHBOARD_PATH, `${path}/unwrapd.json`);
  assert.ok(mounts.includes(`./grafana/unwrapd.json:${path}/unwrapd.json:ro`));
});

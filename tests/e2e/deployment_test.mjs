// What lies in docker/ is right: by the schemas of Kubernetes, in itself, and in the eyes of the
// server whose options it sets. UNWRAPD names the binary.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after } from "node:test";
import yaml from "js-yaml";

import { accepted, checkSchema, folder, image, isIgnored, LONGEST_END, read } from "./deployment.mjs";

const objects = yaml.loadAll(read("kubernetes/unwrapd.yaml"));
const of = (kind) => objects.find((object) => object.kind === kind);
const scratch = mkdtempSync(join(tmpdir(), "unwrapd_deployment_"));
after(() => rmSync(scratch, { recursive: true }));

test("the objects are as Kubernetes' schemas ask", async () => {
  const kinds = objects.map((object) => object.kind);
  assert.deepEqual(kinds.sort(), ["ConfigMap", "Deployment", "NetworkPolicy", "PersistentVolumeClaim", "Service"]);
  for (const object of objects) await checkSchema(object);
});

test("the objects name each other rightly", () => {
  const pod = of("Deployment").spec.template;
  const [container] = pod.spec.containers;
  const ports = container.ports.map((port) => port.name);
  const labels = Object.entries(pod.metadata.labels).flat();
  for (const selector of [of("Deployment").spec.selector.matchLabels, of("Service").spec.selector,
    of("NetworkPolicy").spec.podSelector.matchLabels])
    for (const word of Object.entries(selector).flat()) assert.ok(labels.includes(word), word);
  for (const probe of [container.startupProbe, container.livenessProbe, container.readinessProbe])
    assert.ok(ports.includes(probe.httpGet.port));
  for (const port of [...of("Service").spec.ports.map((one) => one.targetPort),
    ...of("NetworkPolicy").spec.ingress.flatMap((rule) => rule.ports.map((one) => one.port))])
    assert.ok(ports.includes(port), port);
  const [data, config, key] = pod.spec.volumes;
  assert.equal(data.persistentVolumeClaim.claimName, of("PersistentVolumeClaim").metadata.name);
  assert.equal(config.configMap.name, of("ConfigMap").metadata.name);
  assert.deepEqual(container.volumeMounts.map((mount) => mount.name), [data.name, config.name, key.name]);
});

test("the pod runs as the image does: no root, nothing writable, no capability", () => {
  const { spec } = of("Deployment").spec.template;
  const { securityContext } = spec.containers[0];
  assert.equal(spec.securityContext.runAsUser, 10001);
  assert.match(read("Dockerfile"), /^USER 10001:10001$/m);
  assert.equal(securityContext.readOnlyRootFilesystem, true);
  assert.equal(securityContext.allowPrivilegeEscalation, false);
  assert.deepEqual(securityContext.capabilities.drop, ["ALL"]);
  assert.equal(of("Deployment").spec.replicas, 1); // one writer of one database
});

test("what is shipped asks for a key, which it finds where it is mounted", () => {
  const [, , key] = of("Deployment").spec.template.spec.containers[0].volumeMounts;
  const { "unwrapd.toml": toml } = of("ConfigMap").data;
  assert.match(toml, new RegExp(`^key-file = "${key.mountPath}/key"$`, "m"));
  const { services, secrets } = yaml.load(read("compose.yaml"));
  const [secret] = services.unwrapd.secrets;
  assert.equal(services.unwrapd.environment.UNWRAPD_KEY_FILE, `/run/secrets/${secret}`);
  isIgnored(secrets[secret].file);
});

test("the server takes all options of the ConfigMap beside the image's, and is given time to end", () => {
  const file = join(scratch, "unwrapd.toml");
  const toml = of("ConfigMap").data["unwrapd.toml"];
  writeFileSync(file, toml);
  const told = accepted(["--config", file], image);
  for (const [, name] of toml.matchAll(/^([\w-]+) =/gm))
    assert.match(told, new RegExp(`^${name} = .*# from ${file}$`, "m"));
  const drain = Number(/^drain-seconds = (\d+)/m.exec(told)[1]);
  assert.ok(of("Deployment").spec.template.spec.terminationGracePeriodSeconds > drain + LONGEST_END);
  assert.match(told, /^listen = "0.0.0.0:8080"/m);
});

test("the server takes the options of the compose file, and is given time to end", () => {
  const { unwrapd } = yaml.load(read("compose.yaml")).services;
  const told = accepted([], { ...image, ...unwrapd.environment });
  const drain = Number(/^drain-seconds = (\d+)/m.exec(told)[1]);
  assert.ok(parseInt(unwrapd.stop_grace_period) > drain + LONGEST_END);
  for (const port of unwrapd.ports) assert.match(port, /^127\.0\.0\.1:/); // as long as it is plain HTTP
});

test("the image is built with the packages that ./dev builds with", () => {
  const dev = readFileSync(join(folder, "../dev"), "utf8");
  const packages = /^build_packages=\(([^)]*)\)/m.exec(dev)[1].split(/\s+/);
  const only = ["ccache", "libgtest-dev", "libgmock-dev"]; // of tests and of who builds often
  for (const one of packages.filter((name) => name && !only.includes(name)))
    assert.match(read("Dockerfile"), new RegExp(`[ \n]${one.replaceAll("+", "\\+")}[ \n]`), one);
});

test("nginx takes the proxy's configuration", (context) => {
  const found = spawnSync("nginx", ["-v"]);
  if (found.error) return context.skip("nginx is not installed");
  const checked = spawnSync("nginx", ["-t", "-c", join(folder, "nginx.conf")], { encoding: "utf8" });
  assert.equal(checked.status, 0, checked.stderr);
});

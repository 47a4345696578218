// docker/kubernetes/farm.yaml is right: by the schemas of Kubernetes and KEDA, in itself, and in the
// eyes of the server whose options it sets. UNWRAPD names the binary.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after } from "node:test";
import yaml from "js-yaml";

import { accepted, checkSchema, image, LONGEST_END, read, valueOf } from "./deployment.mjs";

const text = read("kubernetes/farm.yaml");
const objects = yaml.loadAll(text);
const of = (kind, name) => objects.find((object) => object.kind === kind && (!name || object.metadata.name === name));
const scratch = mkdtempSync(join(tmpdir(), "unwrapd_kubernetes_"));
after(() => rmSync(scratch, { recursive: true }));

const deployments = [of("Deployment", "unwrapd-serve"), of("Deployment", "unwrapd-worker")];
const [serve, worker] = deployments;
const podOf = (deployment) => deployment.spec.template.spec;
const containerOf = (deployment) => podOf(deployment).containers[0];
const labelsOf = (deployment) => deployment.spec.template.metadata.labels;
const selects = (selector, deployment) => Object.entries(selector).every(([key, value]) => labelsOf(deployment)[key] === value);

/** The options as the server sees them in a pod. */
function told(deployment) {
  const file = join(scratch, "unwrapd.toml");
  writeFileSync(file, of("ConfigMap").data["unwrapd.toml"]);
  const args = containerOf(deployment).args.map((one) => one.replace("/etc/unwrapd/unwrapd.toml", file));
  return accepted(args, { ...image, UNWRAPD_DATABASE: "postgres://unwrapd@db/unwrapd" });
}

test("the objects are as the schemas of Kubernetes and of KEDA ask", async () => {
  const kinds = objects.map((object) => object.kind);
  assert.deepEqual(kinds.sort(), ["ConfigMap", "Deployment", "Deployment", "NetworkPolicy", "PersistentVolumeClaim",
    "PodDisruptionBudget", "PodDisruptionBudget", "ScaledObject", "Service", "TriggerAuthentication"]);
  for (const object of objects) await checkSchema(object);
});

test("selectors find the pods that they are for", () => {
  for (const deployment of deployments) {
    assert.ok(selects(deployment.spec.selector.matchLabels, deployment));
    assert.ok(selects(of("NetworkPolicy").spec.podSelector.matchLabels, deployment));
    const budget = of("PodDisruptionBudget", deployment.metadata.name).spec.selector.matchLabels;
    assert.deepEqual(deployments.filter((one) => selects(budget, one)), [deployment]);
  }
  assert.deepEqual(deployments.filter((one) => selects(of("Service").spec.selector, one)), [serve]);
  const [{ labelSelector }] = podOf(serve).topologySpreadConstraints;
  assert.ok(selects(labelSelector.matchLabels, serve));
});

test("ports, volumes and secrets are there under the names that are used", () => {
  const ports = (deployment) => containerOf(deployment).ports.map((port) => port.name);
  assert.deepEqual(ports(worker), ["admin"]); // it listens for no requests
  for (const { targetPort } of of("Service").spec.ports) assert.ok(ports(serve).includes(targetPort));
  for (const { port } of of("NetworkPolicy").spec.ingress.flatMap((rule) => rule.ports)) assert.ok(ports(serve).includes(port));
  const secrets = new Set([...text.matchAll(/secret generic ([\w-]+)/g)].map(([, name]) => name));
  const keys = new Set([...text.matchAll(/--from-literal=(\w+)=/g)].map(([, key]) => key));
  for (const deployment of deployments) {
    const { volumes } = podOf(deployment);
    const { volumeMounts, env: [{ name, valueFrom }], startupProbe, livenessProbe, readinessProbe } = containerOf(deployment);
    assert.deepEqual(volumeMounts.map((mount) => mount.name), volumes.map((volume) => volume.name));
    const [, blobs, config, key] = volumes;
    assert.equal(blobs.persistentVolumeClaim.claimName, of("PersistentVolumeClaim").metadata.name);
    assert.equal(config.configMap.name, of("ConfigMap").metadata.name);
    assert.ok(secrets.has(key.secret.secretName) && secrets.has(valueFrom.secretKeyRef.name));
    assert.ok(name === "UNWRAPD_DATABASE" && keys.has(valueFrom.secretKeyRef.key));
    assert.deepEqual([startupProbe, livenessProbe, readinessProbe].map((probe) => probe.httpGet.path), ["/healthz", "/healthz", "/readyz"]);
    for (const probe of [startupProbe, livenessProbe, readinessProbe]) assert.ok(ports(deployment).includes(probe.httpGet.port));
  }
  assert.deepEqual(of("PersistentVolumeClaim").spec.accessModes, ["ReadWriteMany"]);
});

test("the pods run as the image does: no root, nothing writable, no capability", () => {
  for (const deployment of deployments) {
    const { securityContext, automountServiceAccountToken } = podOf(deployment);
    assert.equal(securityContext.runAsUser, 10001);
    assert.equal(securityContext.runAsNonRoot, true);
    assert.equal(automountServiceAccountToken, false);
    const container = containerOf(deployment);
    assert.deepEqual(container.securityContext,
      { allowPrivilegeEscalation: false, readOnlyRootFilesystem: true, capabilities: { drop: ["ALL"] } });
    assert.ok(container.resources.limits.memory);
  }
});

test("the server takes all options, which are the same for all nodes where they must be", () => {
  const [ofServe, ofWorker] = deployments.map(told);
  for (const [, option] of of("ConfigMap").data["unwrapd.toml"].matchAll(/^([\w-]+) =/gm))
    assert.match(ofServe, new RegExp(`^${option} = .*# from ${scratch}`, "m"));
  for (const option of ["blobs", "keep-seconds", "max-stored-jobs", "max-disk-bytes", "lease-seconds", "webhook-hosts", "max-job-seconds"])
    assert.deepEqual(valueOf(ofServe, option), valueOf(ofWorker, option), option);
  assert.equal(valueOf(ofServe, "workers"), 0);
  assert.equal(containerOf(worker).args[0], "worker");
  const mounts = containerOf(worker).volumeMounts;
  assert.equal(valueOf(ofWorker, "blobs"), `dir:${mounts[1].mountPath}`);
  assert.equal(valueOf(ofWorker, "data"), mounts[0].mountPath);
  assert.equal(valueOf(ofWorker, "key-file"), `${mounts[3].mountPath}/key`);
  const claimed = parseInt(of("PersistentVolumeClaim").spec.resources.requests.storage) * 2 ** 30;
  assert.ok(valueOf(ofServe, "max-disk-bytes") < claimed);
});

test("a pod is given time to end, and a worker that of the longest job", () => {
  for (const deployment of deployments) {
    const sleep = Number(containerOf(deployment).lifecycle?.preStop.exec.command[1] ?? 0);
    const drain = valueOf(told(deployment), "drain-seconds");
    assert.ok(podOf(deployment).terminationGracePeriodSeconds > sleep + drain + LONGEST_END, deployment.metadata.name);
  }
  assert.ok(valueOf(told(worker), "drain-seconds") >= valueOf(told(worker), "max-job-seconds"));
});

test("the scaler counts jobs by a pod's workers, and nothing else says how many pods there are", () => {
  const { scaleTargetRef, triggers: [{ metadata, authenticationRef }] } = of("ScaledObject").spec;
  assert.equal(scaleTargetRef.name, worker.metadata.name);
  assert.equal(worker.spec.replicas, undefined);
  assert.equal(Number(metadata.targetQueryValue), valueOf(told(worker), "workers"));
  assert.equal(authenticationRef.name, of("TriggerAuthentication").metadata.name);
  const [secret] = of("TriggerAuthentication").spec.secretTargetRef;
  assert.match(text, new RegExp(`secret generic ${secret.name} [^#]*\n(# .*\n)?# .*--from-literal=${secret.key}=`));
});

test("the commands of an upgrade name what there is", () => {
  const guide = readFileSync(new URL("../../docs/farm.md", import.meta.url), "utf8");
  const [, commands] = /```\n(kubectl[^`]+)```/.exec(guide);
  const named = [...commands.matchAll(/\b(scaledobject|deployment)[ /]([\w-]+)/g)].map(([, kind, name]) => `${kind}/${name}`);
  const there = objects.map((object) => `${object.kind.toLowerCase()}/${object.metadata.name}`);
  assert.deepEqual([...new Set(named)].sort(), there.filter((one) => /^(scaledobject|deployment)/.test(one)).sort());
  const [, label, value] = / -l (\S+)=(\S+) /.exec(commands);
  for (const deployment of deployments) assert.equal(labelsOf(deployment)[label], value);
  assert.ok(commands.includes(` ${containerOf(serve).name}=`));
  const [, minutes] = /--timeout=(\d+)m/.exec(commands);
  assert.ok(60 * minutes >= podOf(worker).terminationGracePeriodSeconds);
});

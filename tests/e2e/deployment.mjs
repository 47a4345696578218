// What the tests of docker/ share: its files, and the server that says whether it takes their options.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";

export const folder = join(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../../docker");
export const read = (name) => readFileSync(join(folder, name), "utf8");

export const LONGEST_END = 20; // s after the drain: for jobs that do not stop, and for last answers

/** The variables that the image sets. */
export const image = Object.fromEntries(
  [...read("Dockerfile").matchAll(/(UNWRAPD_\w+)=(\S+)/g)].map(([, name, value]) => [name, value]));

/** The options as the server sees them; fails when it would not start with them. */
export function accepted(flags, environment = {}) {
  const told = spawnSync(process.env.UNWRAPD, [...flags, "--print-config"], {
    env: { PATH: process.env.PATH, ...environment },
    encoding: "utf8",
  });
  assert.equal(told.status, 0, told.stderr);
  return told.stdout;
}

/** An option's value in what accepted() returns. */
export const valueOf = (told, option) => JSON.parse(new RegExp(`^${option} = ([^#\n]+?)(  #.*)?$`, "m").exec(told)[1]);

/** A value that notes which of its members are not read. */
function watched(value, path, unread) {
  if (typeof value !== "object" || value === null) return value;
  const members = Object.fromEntries(Object.entries(value).map(([key, one]) => [key, watched(one, `${path}.${key}`, unread)]));
  for (const key of Object.keys(value)) if (!Array.isArray(value)) unread.add(`${path}.${key}`);
  return new Proxy(value, {
    get(target, key) {
      unread.delete(`${path}.${String(key)}`);
      return Object.hasOwn(members, key) ? members[key] : target[key];
    },
  });
}

/** Fails when an object is not as the schemas of Kubernetes, or of KEDA, ask, or has a member that they do not read. */
export async function checkSchema(object) {
  const home = object.apiVersion.startsWith("keda.sh/") ? "@kubernetes-models/keda" : "kubernetes-models";
  const group = await import(`${home}/${object.apiVersion}`);
  const model = new group[object.kind](object);
  const unread = new Set();
  for (const key of Object.keys(object)) model[key] = watched(object[key], key, unread);
  model.validate();
  assert.deepEqual([...unread], [], `${object.kind} has no such members`);
}

/** Fails when a secret that lies in docker/ could be committed. */
export function isIgnored(file) {
  const ignored = readFileSync(join(folder, "../.gitignore"), "utf8").split("\n");
  assert.ok(ignored.includes(`/docker/${file.replace(/^\.\//, "")}`), `${file} could be committed`);
}

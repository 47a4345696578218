// The program, its contract and its packages have one version.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "../..");

/** [file, the pattern whose group is the version] */
const VERSIONS = [
  ["api/openapi.yaml", /^  version: (\S+)$/m],
  ["client/js/package.json", /"version": "([^"]+)"/],
  ["client/python/pyproject.toml", /^version = "([^"]+)"$/m],
];

const versionIn = (path, pattern) => readFileSync(join(ROOT, path), "utf8").match(pattern)?.[1];

for (const [path, pattern] of VERSIONS)
  test(`${path} has the version of the program`, () => {
    assert.equal(versionIn(path, pattern), versionIn("CMakeLists.txt", /^project\(unwrapd VERSION (\S+) /m));
  });

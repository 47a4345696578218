// Options, methods and formats are listed by name in files that no compiler compares. A new one must
// stand in all of them.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "../..");
const read = (path) => readFileSync(join(ROOT, path), "utf8");

/** api_tests compares this example with the table of options. */
const { options, methods } = JSON.parse(read("api/examples/methods.json"));
const OPTIONS = options.map(({ name }) => name);
const METHODS = methods.map(({ name }) => name);
const FORMATS = read("core/asset/base/input.hpp").match(/enum class Format \{([\s\w,]+)\}/)[1].match(/\w+/g);
const FUZZED = FORMATS.filter((name) => name !== "glb"); // its target is gltf

const mediaType = (format) => ({ glb: "model/gltf-binary", gltf: "model/gltf+json" })[format] ?? `model/${format}`;
const inTicks = (name) => `\`${name}\``;
const quoted = (name) => `"${name}"`;
const ending = (name) => `".${name}"`;
const ofMethod = (name) => new RegExp(`\\bMethod::${name}\\b`);
const word = (name) => new RegExp(`\\b${name}\\b`, "i");

/** [what, names, file, how the file names one: a text or a pattern]. */
const LISTS = [
  ["option", OPTIONS, "docs/options.md", inTicks],
  ["method", METHODS, "docs/options.md", inTicks],
  ["method", METHODS, "README.md", inTicks],
  ["method", METHODS, "client/figure.mjs", word],
  ["method", METHODS, "tests/core/every_method_test.cpp", ofMethod],
  ["method", METHODS, "tests/server/work/any_order_test.cpp", ofMethod],
  ["method", METHODS, "tests/cancel_latency/cancel_latency_test.cpp", ofMethod],
  ["method", METHODS, "tests/bench/methods.cpp", ofMethod],
  ["method", METHODS, "tests/fault/any_order_test.mjs", quoted],
  ["format", FORMATS, "core/asset/zip.cpp", ending],
  ["format", FORMATS, "server/http/media_types.cpp", (name) => `"${mediaType(name)}"`],
  ["format", FORMATS, "client/formats.cpp", quoted],
  ["format", FORMATS, "client/upload.cpp", ending],
  ["format", FORMATS, "client/arguments.cpp", (name) => `.${name}`],
  ["format", FORMATS, "client/web/index.html", (name) => `.${name},`],
  ["format", FORMATS, "client/web/src/files/pick.ts", word],
  ["format", FORMATS, "client/web/src/files/read.ts", (name) => `${name}: '${mediaType(name)}'`],
  ["format", FORMATS, "client/web/src/result/downloads.ts", (name) => `'${name}'`],
  ["format", FORMATS, "api/openapi.yaml", (name) => `          ${mediaType(name)}:\n`],
  ["format", FORMATS, "api/openapi.yaml", (name) => new RegExp(`format:\\n +enum: \\[[^\\]]*\\b${name}\\b`)],
  ["format", FORMATS, "tests/contract/generators/generate.mjs", (name) => `'${mediaType(name)}'`],
  ["format", FUZZED, "tests/fuzz/asset_targets.cpp", (name) => `Target{"${name}"`],
  ["format", FUZZED, "dev", word],
  ["format", FORMATS, "README.md", word],
  ["format", FORMATS, "docs/options.md", word],
];

for (const [what, names, file, howNamed] of LISTS)
  test(`${file} has every ${what} (as ${howNamed("NAME")})`, () => {
    const text = read(file);
    const isThere = (name) => {
      const named = howNamed(name);
      return named instanceof RegExp ? named.test(text) : text.includes(named);
    };
    assert.deepEqual(names.filter((name) => !isThere(name)), []);
  });

const SUITES = [...execFileSync("git", ["grep", "-hE", "^TEST(_F|_P)?[(]", "--", "tests"], { cwd: ROOT, encoding: "utf8" })
  .matchAll(/^TEST(?:_F|_P)?\((\w+),/gm)].map(([, suite]) => suite);

// A test that has another name now would be run again where it takes too long, and nobody would know.
for (const file of ["left_to_all.txt", "compared_in_release.txt"])
  test(`tests/batches/${file} names suites that there are`, () => {
    const named = read(`tests/batches/${file}`).match(/^[A-Z][A-Za-z/]+/gm).map((name) => name.split("/").at(-1));
    assert.deepEqual(named.filter((name) => !SUITES.some((suite) => suite.startsWith(name))), []);
  });

test("the lists are not empty", () => {
  for (const names of [OPTIONS, METHODS, FORMATS]) assert.ok(names.length > 5);
});

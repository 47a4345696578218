// Limits that no operator sets are constants in the code and rows in docs/api.md and docs/options.md.
// Each constant is read from its source here and must stand in the document with its number.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "../..");
const KIB = 1024;

const read = (path) => readFileSync(join(ROOT, path), "utf8");

/** The number that a constant of a source has: sums, products and shifts of literals. */
export function constant(text, name) {
  const found = text.match(new RegExp(`\\b${name}\\s*=\\s*([^;,]+)[;,]`));
  assert.ok(found, `${name} is not defined`);
  const literals = found[1].replace(/(std::)?\w+\{(\d+)\}/g, "$2").replaceAll("'", "");
  assert.match(literals, /^[\d\s.()<*+e-]+$/, `${name} = ${literals} is no expression of literals`);
  return Number(new Function(`return ${literals.replace(/(\d+) *<< *(\d+)/g, "$1 * 2 ** $2")}`)());
}

const plain = (n) => n.toLocaleString("en-US");

/** [document, source, constant, how the document says its number]. */
const LIMITS = [
  ["docs/api.md", "server/http/http_head.hpp", "kMaxHeadBytes", (n) => `${n / KIB} KiB, 8 KiB, 100 fields`],
  ["docs/api.md", "server/http/http_head.hpp", "kMaxLineBytes", (n) => `, ${(n + 2) / KIB} KiB, 100 fields`],
  ["docs/api.md", "server/http/http_head.hpp", "kMaxHeaderFields", (n) => `${n} fields`],
  ["docs/api.md", "server/http/form.hpp", "kMaxPartHead", (n) => `part of a form | ${n / KIB} KiB`],
  ["docs/api.md", "server/uploads/job_input.cpp", "kMaxFieldBytes", (n) => `with their names | ${n / KIB} KiB`],
  ["docs/api.md", "server/uploads/job_input.cpp", "kMaxBuffers", (n) => `${plain(n)} buffers`],
  ["docs/api.md", "api/options.hpp", "kMaxOptionsBytes", (n) => `options as JSON | ${n / KIB / KIB} MiB`],
  ["docs/api.md", "api/json.hpp", "max_depth", (n) => `${n} levels, 2,000,000 values`],
  ["docs/api.md", "api/json.hpp", "max_values", (n) => `${plain(n)} values`],
  ["docs/api.md", "api/json.hpp", "max_members", (n) => `${plain(n)} members of an object`],
  ["docs/api.md", "core/types/asset_options.hpp", "kMaxNames", (n) => `${plain(n)} entries; 32 entries`],
  ["docs/api.md", "api/options.hpp", "kMaxNumbers", (n) => `; ${n} entries`],
  ["docs/api.md", "server/uploads/submissions.cpp", "kLongestKey", (n) => `${n} characters; 2,000`],
  ["docs/api.md", "server/outbound/outbound_url.cpp", "kLongestUrl", (n) => `; ${plain(n)} characters`],
  ["docs/api.md", "server/routes/job_routes.cpp", "kMaxLimit", (n) => `${n} jobs`],
  ["docs/api.md", "core/asset/recognise.cpp", "kBlock", (n) => `not count) | ${n / KIB} KiB`],
  ["docs/api.md", "core/json/json.hpp", "max_depth", (n) => `glTF | ${n} levels`],
  ["docs/api.md", "core/asset/reader/meshes.cpp", "kMaxNames", (n) => `${plain(n)} attributes`],
  ["docs/api.md", "core/asset/reader/geometry_check.cpp", "kMaxZeroElements", (n) => `${plain(n)} elements`],
  ["docs/api.md", "core/asset/reader/geometry_check.cpp", "kFreeAttributeBytes", (n) => `${n / KIB / KIB} MiB, and 64 times`],
  ["docs/api.md", "core/asset/reader/geometry_check.cpp", "kMaxSharing", (n) => `and ${n} times the buffers`],
  ["docs/api.md", "core/asset/codec/draco.cpp", "kFreeFaces", (n) => `${plain(n)} faces, and`],
  ["docs/api.md", "core/asset/codec/draco.cpp", "kFacesPerByte", (n) => `faces, and ${n} for each byte`],
  ["docs/api.md", "core/asset/codec/draco.cpp", "kFreePoints", (n) => `${plain(n)} points and 3`],
  ["docs/api.md", "core/asset/codec/draco.cpp", "kMaxComponents", (n) => `${n} components`],
  ["docs/api.md", "core/asset/codec/draco.cpp", "kMaxAttributeData", (n) => `${n} sets`],
  ["docs/api.md", "core/asset/codec/decompress_meshopt.cpp", "kFreeDecodedBytes", (n) => `${n / KIB / KIB} MiB, and 32 times`],
  ["docs/api.md", "core/asset/codec/decompress_meshopt.cpp", "kMaxDocumentRatio", (n) => `and ${n} times the buffers, 2 GiB`],
  ["docs/api.md", "core/asset/codec/decompress_meshopt.cpp", "kMaxDecodedBytes", (n) => `${n / KIB / KIB / KIB} GiB in all`],
  ["docs/api.md", "core/texture/image.hpp", "kMaxSide", (n) => `${plain(n)} texels;`],
  ["docs/api.md", "core/texture/jpeg.cpp", "kMaxScans", (n) => `${n} scans |`],
  ["api/openapi.yaml", "core/measure/overlaps.hpp", "kMostPairs", (n) => `most ${plain(n)} are counted`],
  ["docs/options.md", "core/asset/writer/transfer_plan.cpp", "kMostSide", (n) => `up to ${n} a side`],
  ["docs/options.md", "core/types/options.hpp", "kMinResolution", (n) => `1024 (${n} to 16384)`],
  ["docs/options.md", "core/types/options.hpp", "kMaxResolution", (n) => `to ${n})`],
  ["docs/options.md", "core/types/options.hpp", "kMinDistortion", (n) => `from ${n} to 1e6`],
  ["docs/options.md", "core/types/options.hpp", "kMaxPages", (n) => `1, up to ${n}: islands`],
  ["docs/api.md", "core/asset/zip.cpp", "kMaxEntries", (n) => `zip archive: files; all bytes that are unpacked from it | ${n.toLocaleString("en")} files`],
  ["docs/options.md", "core/types/asset_options.hpp", "kMaxTexcoord", (n) => `0 to ${n}: that set`],
  ["docs/options.md", "api/option_table.cpp", "kMaxCharts", (n) => `N up to ${plain(n)}`],
  ["docs/options.md", "api/option_table.cpp", "kMaxTolerance", (n) => `1e-12 to ${n})`],
  ["docs/options.md", "api/options.hpp", "kMaxNumbers", (n) => `up to ${n} (`],
];

for (const [document, source, name, phrase] of LIMITS)
  test(`${document} says ${name} of ${source}`, () => {
    const expected = phrase(constant(read(source), name));
    assert.ok(read(document).includes(expected), `"${expected}" does not stand in ${document}`);
  });

test("a constant's number is computed from literals", () => {
  assert.equal(constant("inline constexpr std::size_t kA = std::size_t{8} * 1024 - 2;", "kA"), 8190);
  assert.equal(constant("int max_depth = 16;", "max_depth"), 16);
  assert.throws(() => constant("constexpr int kA = kB;", "kA"));
});

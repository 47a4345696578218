// The layer check can fail: each rule is broken once, in a file that exists only here.
import assert from "node:assert/strict";
import test from "node:test";

import { check, twins } from "./check_layers.mjs";

const including = (path, header) => check(path, `#include ${header}\n`);
const refuses = (path, header) => assert.notDeepEqual(including(path, header), [], `${path} ${header}`);
const accepts = (path, header) => assert.deepEqual(including(path, header), [], `${path} ${header}`);

test("core's folders include downwards only", () => {
  refuses("core/mesh/weld.cpp", '"core/solve/arap.hpp"');
  refuses("core/measure/energy.cpp", '"core/linear/cholesky.hpp"');
  refuses("core/solve/arap.cpp", '"core/atlas/pack.hpp"');
  refuses("core/asset/gltf.cpp", '"core/atlas/pack.hpp"');
  refuses("core/asset/gltf.cpp", '"core/options.hpp"');
  refuses("core/atlas/pack.cpp", '"core/unwrap.hpp"');
  refuses("core/unwrap.cpp", '"core/asset/asset.hpp"');
  refuses("core/measure/energy.cpp", '"core/figure/image.hpp"');
  refuses("core/figure/preview.cpp", '"core/solve/arap.hpp"');
  accepts("core/figure/preview.cpp", '"core/measure/jacobian.hpp"');
  accepts("core/solve/arap.cpp", '"core/linear/cholesky.hpp"');
  accepts("core/atlas/charts.cpp", '"core/options.hpp"');
  accepts("core/unwrap.cpp", '"core/atlas/pack.hpp"');
});

test("nobody reaches past the layer below", () => {
  refuses("api/job.cpp", '"core/unwrap.hpp"');
  refuses("api/job.cpp", '"client/http.hpp"');
  refuses("client/run.cpp", '"core/report.hpp"');
  refuses("client/run.cpp", '"server/queue.hpp"');
  refuses("tests/api/job_test.cpp", '"server/queue.hpp"');
  accepts("api/job.cpp", '"core/report.hpp"');
  accepts("client/run.cpp", '"api/job.hpp"');
  accepts("server/worker.cpp", '"core/asset/asset.hpp"');
});

test("a library is seen by its own folder only", () => {
  refuses("client/run.cpp", "<httplib.h>");
  refuses("core/unwrap.cpp", "<nlohmann/json.hpp>");
  refuses("core/unwrap.cpp", "<thread>");
  refuses("core/solve/arap.cpp", "<chrono>");
  refuses("core/solve/arap.cpp", "<iostream>");
  refuses("client/run.cpp", "<spdlog/spdlog.h>");
  refuses("core/figure/image.cpp", "<png.h>");
  accepts("server/png_file.cpp", "<png.h>");
  refuses("api/job.cpp", "<draco/compression/decode.h>");
  accepts("client/http.cpp", "<httplib.h>");
  accepts("core/asset/gltf.cpp", "<nlohmann/json.hpp>");
  accepts("client/interrupt.cpp", "<thread>");
});

test("files stay short", () => {
  assert.deepEqual(check("core/a.cpp", "\n".repeat(300)), []);
  assert.equal(check("core/a.cpp", "\n".repeat(301)).length, 1);
  assert.equal(check("tests/contract/a.mjs", "\n".repeat(301)).length, 1);
  assert.equal(check("CMakeLists.txt", "\n".repeat(61)).length, 1);
  assert.equal(check("README.md", "\n".repeat(101)).length, 1);
});

test("left-overs and private paths are found", () => {
  assert.equal(check("core/a.cpp", "// TODO: later\n").length, 1);
  assert.equal(check("README.md", "see /home/x\n").length, 1);
  assert.equal(check("tests/package-lock.json", '"resolved": "https://"\n').length, 1);
});

test("no two headers define a type of one name", () => {
  const a = { path: "core/a.hpp", text: "namespace unwrapd {\nstruct Patch {\n" };
  const b = { path: "core/b.hpp", text: "namespace unwrapd {\nclass Patch final {\n" };
  const other = { path: "core/c.hpp", text: "namespace unwrapd::asset {\nstruct Patch {\n" };
  const named = { path: "core/d.hpp", text: "namespace unwrapd {\nstruct Patch;\n" };
  assert.deepEqual(twins([a, other, named]), []);
  assert.deepEqual(twins([a, b]), ["core/b.hpp: unwrapd::Patch is defined in core/a.hpp, too"]);
});

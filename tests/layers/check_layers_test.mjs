// The layer check can fail: each rule is broken once, in a file that exists only here.
import assert from "node:assert/strict";
import test from "node:test";

import { check, deadMentions, deadPaths, strangers, twins } from "./check_layers.mjs";
import { ROOMS, upward } from "./rooms.mjs";
import { circlesOf, roomGraph, structure } from "./structure.mjs";

const including = (path, header) => check(path, `#include ${header}\n`);
const refuses = (path, header) => assert.notDeepEqual(including(path, header), [], `${path} ${header}`);
const accepts = (path, header) => assert.deepEqual(including(path, header), [], `${path} ${header}`);

test("rooms include the rooms before them only", () => {
  refuses("core/mesh/weld.cpp", '"core/solve/solve.hpp"');
  refuses("core/measure/energy.cpp", '"core/linear/cholesky.hpp"');
  refuses("core/solve/arap/objective.cpp", '"core/pack/pack.hpp"');
  refuses("core/solve/maps/conformal.cpp", '"core/solve/repair/untangle.hpp"');
  refuses("core/asset/gltf/gltf.cpp", '"core/pack/pack.hpp"');
  refuses("core/pack/pack.cpp", '"core/unwrap.hpp"');
  refuses("core/pack/pack.cpp", '"core/segment/segment.hpp"');
  refuses("core/unwrap.cpp", '"core/asset/asset.hpp"');
  refuses("core/figure/preview.cpp", '"core/solve/solve.hpp"');
  refuses("core/segment/base/merge.cpp", '"core/segment/search/merge_search.hpp"');
  refuses("core/segment/search/bisect.cpp", '"core/segment/segment.hpp"');
  refuses("server/blobs/blob_store.cpp", '"server/database/database.hpp"');
  refuses("server/database/schema.cpp", '"server/store/job_rows.hpp"');
  refuses("server/routes/job_routes.cpp", '"server/database/database.hpp"');
  refuses("server/http/http.cpp", '"server/store/job_store.hpp"');
  refuses("server/store/job_store.cpp", '"server/http/http.hpp"');
  refuses("server/jobs/job_queue.cpp", '"server/routes/job_routes.hpp"');
  refuses("server/base/log.cpp", '"server/service.hpp"');
  refuses("tests/core/unwrap_test.cpp", '"server/service.hpp"');
  refuses("client/run.cpp", '"server/service.hpp"');
  accepts("core/figure/preview.cpp", '"core/measure/jacobian.hpp"');
  accepts("core/solve/arap/global_step.cpp", '"core/linear/cholesky.hpp"');
  accepts("core/charts/charts.cpp", '"core/types/options.hpp"');
  accepts("core/unwrap.cpp", '"core/guarantee/keep_guarantee.hpp"');
  accepts("server/jobs/job_queue.cpp", '"server/store/job_store.hpp"');
});

test("every source is in a room", () => {
  assert.deepEqual(check("core/attic/a.cpp", ""), ["core/attic/a.cpp: is in no room"]);
  assert.deepEqual(check("server/http/a.cpp", ""), []);
  refuses("server/service.cpp", '"server/attic/a.hpp"');
});

test("the top of the tree has the seven folders alone", () => {
  assert.deepEqual(strangers(["core/unwrap.cpp", "dev", ".ci/run"]), []);
  assert.equal(strangers(["core/unwrap.cpp", "cmake/a.cmake", "cmake/b.cmake"]).length, 1);
});

test("a file opens the namespace of its room", () => {
  const opening = (path, space) => check(path, `namespace ${space} {\n`);
  assert.deepEqual(opening("core/pack/pack.cpp", "unwrapd::pack"), []);
  assert.deepEqual(opening("core/solve/base/disk.cpp", "unwrapd::solve"), []);
  assert.deepEqual(opening("core/types/options.cpp", "unwrapd"), []);
  assert.deepEqual(opening("server/base/log.cpp", "unwrapd::server"), []);
  assert.deepEqual(opening("server/http/router.cpp", "unwrapd::server::http"), []);
  assert.equal(opening("core/pack/pack.cpp", "unwrapd").length, 1);
  assert.equal(opening("core/pack/pack.cpp", "unwrapd::packing").length, 1);
  assert.equal(opening("server/http/router.cpp", "unwrapd::server::store").length, 1);
});

test("a rounding to float and back stands in core/asset alone", () => {
  for (const line of ["p.cast<float>().cast<double>()", "static_cast<double>(static_cast<float>(x))", "double{float{x}}"]) {
    assert.equal(check("core/pack/pack.cpp", line).length, 1, line);
    assert.deepEqual(check("core/asset/asset.cpp", line), []);
  }
  assert.deepEqual(check("core/pack/pack.cpp", "static_cast<float>(static_cast<double>(x))"), []);
});

test("a table that goes both ways is refused", () => {
  const upstairs = { folder: "a", includes: ["b"] };
  const downstairs = { folder: "b", includes: [] };
  assert.deepEqual(upward([downstairs, upstairs]), []);
  assert.equal(upward([upstairs, downstairs]).length, 1);
  assert.equal(upward([{ folder: "a", includes: ["unknown"] }]).length, 1);
  assert.deepEqual(upward(ROOMS), []);
});

test("the figures of the structure tell circles and includes that go up", () => {
  const file = (path, ...headers) => ({ path, text: headers.map((header) => `#include "${header}"\n`).join("") });
  const oneWay = [file("core/a/x.hpp"), file("core/b/y.hpp", "core/a/x.hpp"), file("core/c/z.cpp", "core/b/y.hpp")];
  const round = [...oneWay, file("core/a/x.cpp", "core/c/z.hpp", "core/c/w.hpp")];
  assert.deepEqual(circlesOf(roomGraph(oneWay)), { circles: [], up: 0 });
  assert.deepEqual(circlesOf(roomGraph(round)), { circles: ["core/a, core/b, core/c"], up: 4 });
  const figures = new Map(structure([...round, { path: "core/a/t.hpp", text: "struct A {\nstruct B;\n" }]));
  assert.equal(figures.get("rooms (folders with sources)"), 3);
  assert.equal(figures.get("types in headers"), 1);
  assert.equal(figures.get("longest file, lines"), 2);
});

test("nobody reaches past the layer below", () => {
  refuses("api/job.cpp", '"core/unwrap.hpp"');
  refuses("api/job.cpp", '"client/http.hpp"');
  refuses("client/run.cpp", '"core/types/report.hpp"');
  refuses("client/run.cpp", '"server/jobs/job_queue.hpp"');
  refuses("tests/api/job_test.cpp", '"server/jobs/job_queue.hpp"');
  accepts("api/job.cpp", '"core/types/report.hpp"');
  accepts("client/run.cpp", '"api/job.hpp"');
  accepts("server/work/run_job.cpp", '"core/asset/asset.hpp"');
});

test("a library is seen by its own folder only", () => {
  refuses("client/run.cpp", "<httplib.h>");
  refuses("core/unwrap.cpp", "<nlohmann/json.hpp>");
  refuses("core/unwrap.cpp", "<thread>");
  refuses("core/solve/solve.cpp", "<chrono>");
  refuses("core/solve/solve.cpp", "<iostream>");
  refuses("client/run.cpp", "<spdlog/spdlog.h>");
  refuses("core/figure/image.cpp", "<png.h>");
  accepts("server/work/png_file.cpp", "<png.h>");
  refuses("api/job.cpp", "<draco/compression/decode.h>");
  accepts("client/http.cpp", "<httplib.h>");
  accepts("core/asset/gltf/gltf.cpp", "<nlohmann/json.hpp>");
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

test("comments name files that exist", () => {
  const source = { path: "core/a.cpp", text: '#include <json.hpp>\nint a;  // see b.hpp\n' };
  assert.deepEqual(deadMentions([source], new Set(["b.hpp"])), []);
  assert.deepEqual(deadMentions([source], new Set(["a.hpp"])), ["core/a.cpp: b.hpp, which a comment names, does not exist"]);
});

test("no two headers define a type of one name", () => {
  const a = { path: "core/a.hpp", text: "namespace unwrapd {\nstruct Patch {\n" };
  const b = { path: "core/b.hpp", text: "namespace unwrapd {\nclass Patch final {\n" };
  const other = { path: "core/c.hpp", text: "namespace unwrapd::asset {\nstruct Patch {\n" };
  const named = { path: "core/d.hpp", text: "namespace unwrapd {\nstruct Patch;\n" };
  assert.deepEqual(twins([a, other, named]), []);
  assert.deepEqual(twins([a, b]), ["core/b.hpp: unwrapd::Patch is defined in core/a.hpp, too"]);
});

test("guides name files that exist", () => {
  const exists = (name) => ["core/unwrap.cpp", "docs/api.md", "SECURITY.md"].includes(name);
  const dead = (path, text) => deadPaths(path, text, exists).length;
  assert.equal(dead("CONTRIBUTING.md", "`core/unwrap.cpp`, `core/unwrap`, [here](docs/api.md#a), `GET /v1`"), 0);
  assert.equal(dead("docs/api.md", "[here](../SECURITY.md), [there](https://example.com)"), 0);
  assert.equal(dead("CONTRIBUTING.md", "`core/gone.cpp`"), 1);
  assert.equal(dead("CONTRIBUTING.md", "`web/page.js`"), 1);
  assert.equal(dead("docs/api.md", "[here](SECURITY.md)"), 1);
  assert.equal(dead("docs/adr/0001-a.md", "`core/unwrap.cpp`, `core/unwrap`, `model/obj`, `GET`, `std::vector`"), 0);
  for (const gone of ["core/gone.cpp", "core/gone", "atlas/gone", "solve/unwrap", "unwrap.cpp"])
    assert.equal(dead("docs/adr/0001-a.md", `\`${gone}\``), 1, gone);
});

test("tests share no fixed temporary name", () => {
  const tells = (line) => check("tests/asset/a_test.cpp", `${line}\n`).length;
  assert.equal(tells('const auto folder = std::filesystem::path(testing::TempDir()) / "unwrapd_asset";'), 1);
  assert.equal(tells('std::ofstream file("/tmp/unwrapd.obj");'), 1);
  assert.equal(tells("const server::TempDir own;"), 0);
  assert.equal(tells('mistake({"--config", "/tmp"});'), 0);
});

test("folders of the page import one way", () => {
  const tells = (path, from) => check(`client/web/src/${path}`, `import {a} from '${from}';\n`).length;
  assert.equal(tells("view/solid.ts", "../mesh/model.js"), 0);
  assert.equal(tells("view/solid.ts", "./stage.js"), 0);
  assert.equal(tells("view/solid.ts", "three"), 0);
  assert.equal(tells("job/run.ts", "../../../js/src/job.js"), 0);
  assert.equal(tells("main.ts", "./app/session.js"), 0);
  assert.equal(tells("mesh/model.ts", "../view/solid.js"), 1);
  assert.equal(tells("app/session.ts", "../main.js"), 1);
});

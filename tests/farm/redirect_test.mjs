// Results that a real bucket hands out itself: nodes answer with links to it. The links give the
// bytes of a node alone, to those alone who may have them, for a time; and no key of the API goes to
// the bucket, whoever downloads.
import assert from "node:assert/strict";
import { execFile, execFileSync } from "node:child_process";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { createServer, request as ask } from "node:http";
import { dirname, join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";

import { isInstalled, NOT_INSTALLED, Radosgw } from "../bucket/radosgw.mjs";
import { install } from "../client/js/installed.mjs";
import { request } from "../contract/http.mjs";
import { Contract } from "../contract/spec.mjs";
import { dataDirectory, FAKETIME, grid, QUICK, Server } from "../fault/server.mjs";
import { Farm, options as ofFarm, send } from "./nodes.mjs";

const ROOT = fileURLToPath(new URL("../..", import.meta.url));
const PATH = `/v1/jobs?preset=chart&${QUICK}`;
const options = isInstalled() ? ofFarm : { skip: NOT_INSTALLED };
const run = promisify(execFile);

/** The bucket under the address that clients know; it notes what arrives there. */
async function publicSide(t, store) {
  const seen = [];
  const server = createServer((from, to) => {
    seen.push({ method: from.method, path: from.url, headers: from.headers });
    const { hostname, port } = new URL(store.endpoint);
    const { method, url, headers } = from; // Host, too, as it is signed
    ask({ hostname, port, method, path: url, headers, agent: false }, (answer) => {
      to.writeHead(answer.statusCode, answer.headers);
      answer.pipe(to);
    }).end();
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  t.after(() => server.closeAllConnections() ?? server.close());
  return { seen, url: `http://127.0.0.1:${server.address().port}` };
}

test("results that the bucket hands out", options, async (t) => {
  const store = await Radosgw.start();
  t.after(() => store.remove());
  store.s3("PUT", "/jobs");
  Object.assign(process.env, store.environment());
  const bucket = await publicSide(t, store);
  const farm = new Farm(t);
  farm.blobs = ["--blobs", "s3://jobs/farm", "--s3-endpoint", store.endpoint];
  const REDIRECTS = ["--blob-redirect", "--blob-redirect-endpoint", bucket.url];
  const node = await farm.start("node", 1, ...REDIRECTS, "--require-keys", "--isolate=off");
  const other = await farm.start("other", 0, ...REDIRECTS, "--require-keys");
  const alone = await Server.start(dataDirectory(t));
  const [key, foreign] = ["a", "b"].map((name) => farm.addKey("--name", name));
  const as = (one, headers = {}) => ({ Authorization: `Bearer ${one}`, ...headers });
  const made = async (path = PATH, size = 6) => {
    const { id } = await (await send(node, path, { size, headers: as(key) })).json();
    await request(node.url, { path: `/v1/jobs/${id}/events`, headers: as(key) });
    return id;
  };
  const resultOf = (id, { at = node, query = "", headers = as(key), ...more } = {}) =>
    request(at.url, { path: `/v1/jobs/${id}/result${query}`, headers, ...more });
  const follow = (answer, headers = {}, method = "GET") => request(bucket.url, { path: answer.headers.location, headers, method });
  const aloneFrom = async (path, size, query = "") => {
    const { id } = await (await send(alone, path, { size })).json();
    await alone.finished(id);
    return request(alone.url, { path: `/v1/jobs/${id}/result${query}` });
  };
  const id = await made();
  const expected = await aloneFrom(PATH, 6);

  await t.test("the options that make no sense are refused at the start", () => {
    const start = (...flags) => execFileSync(process.env.UNWRAPD, ["--data", dataDirectory(t), ...flags], { stdio: "pipe" });
    assert.throws(() => start("--blob-redirect"), /--blob-redirect sends clients to a bucket; give its name, too/);
    assert.throws(() => start("--blob-redirect-endpoint", "http://a"), /give --blob-redirect, too/);
    assert.throws(() => start("--blob-redirect-endpoint", "http://a/b"), /without a path/);
  });

  await t.test("a link as documented gives the bytes and the type of a node alone", async () => {
    const contract = new Contract(join(ROOT, "api/openapi.yaml"));
    for (const at of [node, other]) {
      const answer = await resultOf(id, { at });
      assert.equal(answer.status, 307);
      assert.deepEqual(contract.judge("getResult", answer), []);
      assert.equal(answer.headers.etag, expected.headers.etag);
      assert.match(answer.headers.location, /[?&]X-Amz-Expires=300&/);
      const got = await follow(answer);
      assert.ok(got.body.equals(expected.body));
      for (const name of ["content-type", "cache-control", "content-length"]) assert.equal(got.headers[name], expected.headers[name], name);
      assert.equal((await follow(answer, { Range: "bytes=4-11" })).body.toString(), expected.body.subarray(4, 12).toString());
    }
    const head = await resultOf(id, { method: "HEAD" });
    assert.equal(head.status, 307);
    const size = await follow(head, {}, "HEAD");
    assert.deepEqual([size.status, size.headers["content-length"]], [200, String(expected.body.length)]);
    const known = await resultOf(id, { headers: as(key, { "If-None-Match": expected.headers.etag }) });
    assert.equal(known.status, 304);
    const conditional = await resultOf(id, { headers: as(key, { "If-Match": expected.headers.etag }) });
    assert.equal(conditional.status, 200, "the bucket does not know the tags of nodes");
    const page = await request(node.url, { path: "/" });
    assert.match(page.headers["content-security-policy"], new RegExp(`connect-src [^;]*${bucket.url}`), "the page may go there");
  });

  await t.test("what the bucket has not in this form comes from the node", async () => {
    const path = `${PATH}&method=hybrid&lambda=0.1,10`;
    const curve = await made(path);
    for (const [query, status] of [["", 307], ["?lambda=0.1", 307], ["?lambda=10", 200]]) {
      const answer = await resultOf(curve, { query });
      assert.equal(answer.status, status, query);
      const got = status === 307 ? await follow(answer) : answer;
      assert.ok(got.body.equals((await aloneFrom(path, 6, query)).body), query);
    }
    for (const type of ["application/json", "model/gltf-binary"]) {
      const answer = await resultOf(id, { headers: as(key, { Accept: type }) });
      assert.deepEqual([answer.status, answer.headers["content-type"]], [200, type]);
    }
    assert.equal((await request(node.url, { path: `/v1/jobs/${id}/result.json`, headers: as(key) })).status, 200);
    const body = Buffer.from(grid(6));
    const headers = as(key, { "Content-Type": "model/obj" });
    const at_once = await request(node.url, { method: "POST", path: `/v1/unwrap?preset=chart&${QUICK}`, headers, body });
    assert.deepEqual([at_once.status, at_once.body.equals(expected.body)], [200, true]);
  });

  await t.test("who may not have a result gets no link, and a link cannot be changed", async () => {
    for (const [headers, status] of [[as(foreign), 404], [as("unwrapd_none"), 401], [{}, 401]]) {
      const answer = await resultOf(id, { headers });
      assert.deepEqual([answer.status, answer.headers.location], [status, undefined]);
    }
    const { location } = (await resultOf(id)).headers;
    const changes = [["X-Amz-Expires=300", "X-Amz-Expires=3000"], ["result.obj", "report.json"], [/X-Amz-Signature=./, "X-Amz-Signature=-"],
      ["response-content-type=model", "response-content-type=text"]];
    for (const [from, to] of changes) {
      const changed = location.replace(from, to);
      assert.notEqual(changed, location);
      assert.equal((await request(bucket.url, { path: changed })).status, 403, to);
    }
    assert.equal((await request(bucket.url, { path: location, method: "DELETE" })).status, 403);
  });

  await t.test("a link ends", { skip: !existsSync(FAKETIME) && "libfaketime is not installed" }, async () => {
    const late = { LD_PRELOAD: FAKETIME, FAKETIME_DONT_FAKE_MONOTONIC: "1" };
    const flags = ["--database", farm.url, ...farm.blobs, ...REDIRECTS, "--workers", "0"];
    const at = await Server.startIn({ ...late, FAKETIME: "-4m" }, dataDirectory(t), ...flags);
    assert.equal((await follow(await resultOf(id, { at, headers: {} }))).status, 200, "four minutes old");
    const then = await Server.startIn({ ...late, FAKETIME: "-6m" }, dataDirectory(t), ...flags);
    assert.equal((await follow(await resultOf(id, { at: then, headers: {} }))).status, 403, "six minutes old");
  });

  await t.test("all clients follow, and none shows its key to the bucket", async () => {
    const folder = dataDirectory(t);
    const mesh = join(folder, "mesh.obj");
    writeFileSync(mesh, grid(6));
    const wanted = { preset: "chart", stop: { iterations: 2 } };
    bucket.seen.length = 0;

    const env = { ...process.env, UNWRAP_API_KEY: key, UNWRAPD_SERVER: node.url, PYTHONPATH: join(ROOT, "client/python") };
    const cli = join(dirname(process.env.UNWRAPD), "unwrap");
    await run(cli, [mesh, "-o", join(folder, "cli.obj"), "--server", node.url, "--preset", "chart", "--stop-iterations", "2"], { env });
    const script = `import json, sys, unwrapd
open(sys.argv[2], "wb").write(unwrapd.unwrap(sys.argv[1], json.loads(sys.argv[3]), key=sys.argv[4]).asset)`;
    await run("python3", ["-c", script, mesh, join(folder, "python.obj"), JSON.stringify(wanted), key], { env });
    const installed = install();
    t.after(() => installed.remove());
    const { unwrap } = await installed.load("index.js");
    const { asset } = await unwrap(new Blob([grid(6)]), wanted, { server: node.url, key });
    writeFileSync(join(folder, "js.obj"), Buffer.from(await asset.arrayBuffer()));
    const words = ["-sSfL", "-H", `Authorization: Bearer ${key}`, "-o", join(folder, "curl.obj")];
    await run("curl", [...words, `${node.url}/v1/jobs/${id}/result`]);

    for (const name of ["cli", "python", "js", "curl"])
      assert.ok(readFileSync(join(folder, `${name}.obj`)).equals(expected.body), name);
    assert.equal(bucket.seen.filter(({ path }) => path.includes("result.obj")).length, 4);
    for (const { headers } of bucket.seen) assert.ok(!JSON.stringify(headers).includes(key), JSON.stringify(headers));
  });

  await t.test("a signed link goes on to the bucket, until the job is gone", async () => {
    const link = await request(node.url, { path: `/v1/jobs/${id}/link`, headers: as(key) });
    const path = JSON.parse(link.body).url;
    assert.ok((await follow(await request(node.url, { path }))).body.equals(expected.body));
    assert.equal((await request(node.url, { method: "DELETE", path: `/v1/jobs/${id}`, headers: as(key) })).status, 204);
    assert.equal((await resultOf(id, { at: other })).status, 404);
  });
});

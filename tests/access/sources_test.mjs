// Jobs that name their mesh by an address, at servers of files on this machine.
import assert from "node:assert/strict";
import test from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { dataDirectory, grid, Server } from "../fault/server.mjs";
import { accepted, ALLOWED, ask, files, isClean, obj, raw, refused, upload } from "./source_files.mjs";

const MESH = grid(8);

/** A server of unwrapd and its directory, gone after the test. */
async function start(t, ...flags) {
  const data = dataDirectory(t);
  const server = await Server.start(data, ...flags);
  return { server, data };
}

async function result(server, id) {
  assert.equal((await server.finished(id)).state, "succeeded");
  return Buffer.from(await (await fetch(`${server.url}/v1/jobs/${id}/result`)).arrayBuffer());
}

test("no address is read unless the operator names its host", async (t) => {
  const from = await files(t, obj(MESH));
  const { server: off } = await start(t);
  await refused(await ask(off, from.at("/x.obj")), 422, "source_refused");
  const { server: other } = await start(t, "--source-hosts", "example.com", "--source-private", "--source-http");
  const words = await refused(await ask(other, from.at("/x.obj")), 422, "source_refused");
  assert.match(words, /localhost.*--source-hosts/);
  const { server: strict, data } = await start(t, "--source-hosts", "*");
  assert.match(await refused(await ask(strict, from.at("/x.obj")), 422, "source_refused"), /https/);
  assert.equal(from.hits.length, 0);
  assert.ok(isClean(data));
});

test("the mesh at an address makes the job that its bytes make", async (t) => {
  const from = await files(t, obj(MESH));
  const { server, data } = await start(t, ...ALLOWED, "--log-level", "info");
  const sent = await accepted(await upload(server, MESH));
  const expected = await result(server, sent.id);
  const anew = { "Cache-Control": "no-cache" };
  const named = await accepted(await ask(server, from.at("/a%20b/x.obj?token=hush&b=[1]"), { headers: anew }));
  assert.deepEqual(await result(server, named.id), expected);
  assert.equal(from.hits[0].url, "/a%20b/x.obj?token=hush&b=[1]");
  assert.equal(from.hits[0].headers["accept-encoding"], undefined);
  assert.match(from.hits[0].headers["user-agent"], /^unwrapd\/\d/);
  const stored = await ask(server, from.at("/x.obj"), { headers: { Prefer: "wait=60" } });
  assert.equal(stored.status, 200, "a repeated question is answered from the store");
  assert.deepEqual(await result(server, (await stored.json()).id), expected);
  const sync = await ask(server, from.at("/x.obj"), { path: "/v1/unwrap" });
  assert.equal(sync.status, 200);
  assert.ok(isClean(data));
  await server.end("SIGTERM");
  const lines = server.log.trim().split("\n").map(JSON.parse).filter(({ event }) => event === "source asked for");
  assert.deepEqual(lines.map(({ host, outcome, bytes }) => [host, outcome, bytes]),
    Array(3).fill(["localhost", "read", MESH.length]));
  assert.ok(!server.log.includes("hush"), "addresses may hold tokens");
});

test("what is no address of a mesh is refused in words", async (t) => {
  const { server } = await start(t, ...ALLOWED);
  for (const source of ["file:///etc/passwd", "ftp://localhost/x.obj", "http://u:p@localhost/x.obj", "localhost/x.obj",
    "http://localhost/x.obj#part", "http://localhost:0/x.obj", "http://localhost/\r\nX: y", "gopher://localhost/"])
    await refused(await ask(server, source), 422, "source_refused");
  for (const source of [7, null, "", ["http://localhost/"]])
    await refused(await ask(server, source), 422, "invalid_option");
  const both = { source: "http://localhost/x.obj", mesh: "0".repeat(64) };
  await refused(await ask(server, "", { body: both }), 422, "invalid_option");
  await refused(await ask(server, "", { body: { options: {} } }), 422, "invalid_option", "/mesh");
});

test("options are checked before anything is read", async (t) => {
  const from = await files(t, obj(MESH));
  const { server } = await start(t, ...ALLOWED);
  const body = { source: from.at("/x.obj"), options: { method: "none" } };
  await refused(await ask(server, "", { body }), 422, "invalid_option", "/options/method");
  const long = { stop: { iterations: 2 }, materials: ["x".repeat(100_000)] }; // processed one at a time
  const wrong = { ...body, options: { ...long, method: "none" } };
  await refused(await ask(server, "", { body: wrong }), 422, "invalid_option", "/options/method");
  assert.equal(from.hits.length, 0);
  const both = [1, 2].map(() => ask(server, "", { body: { ...body, options: long } }));
  for (const answer of await Promise.all(both)) await accepted(answer);
});

test("each redirect is checked like the address itself", async (t) => {
  const inside = await files(t, obj(MESH), "127.0.0.2", "127.0.0.2");
  const from = await files(t, (request, response) => {
    const path = new URL(request.url, "http://x").pathname;
    const hop = Number(path.match(/^\/hop(\d+)/)?.[1] ?? 0);
    const to = { "/up": "/x.obj#top", "/back": "../x.obj", "/in": inside.at("/x.obj"), "/file": "file:///etc/passwd",
      "/user": from.at("/x.obj").replace("//", "//u@"), "/round": "/round" }[path];
    if (hop > 0) return response.writeHead(308, { Location: hop > 1 ? `/hop${hop - 1}` : "/x.obj" }).end();
    if (path === "/nowhere") return response.writeHead(302).end();
    if (to) return response.writeHead(302, { Location: to, "Content-Type": "text/html" }).end("<a>there</a>");
    obj(MESH)(request, response);
  });
  const { server, data } = await start(t, ...ALLOWED);
  for (const path of ["/up", "/back", "/hop5"]) await accepted(await ask(server, from.at(path)));
  for (const path of ["/in", "/file", "/user"]) {
    const words = await refused(await ask(server, from.at(path)), 422, "source_refused");
    assert.ok(!words.includes("127.0.0.2") && !words.includes("passwd"), words);
  }
  for (const path of ["/hop6", "/round", "/nowhere"])
    await refused(await ask(server, from.at(path)), 422, "source_failed");
  assert.equal(inside.hits.length, 0);
  assert.ok(isClean(data));
});

test("an address that does not answer with the file is told in words, and nothing is kept", async (t) => {
  const answers = {
    "/404.obj": [(response) => response.writeHead(404).end(), "source_failed", /404/],
    "/500.obj": [(response) => response.writeHead(500).end(MESH), "source_failed", /500/],
    "/206.obj": [(response) => response.writeHead(206).end(MESH), "source_failed", /206/],
    "/empty.obj": [(response) => response.writeHead(200).end(), "source_failed", /empty/],
    "/zipped.obj": [(response) => response.writeHead(200, { "Content-Encoding": "gzip" }).end("x"), "source_failed", /compressed/],
    "/page": [(response) => response.writeHead(200, { "Content-Type": "text/html" }).end("<p>"), "unsupported_media_type", /ending/],
    "/reset.obj": [(response) => response.writeHead(200).write(MESH, () => response.socket.resetAndDestroy()), "source_failed", /ended/],
    "/short.obj": [(response) => response.writeHead(200, { "Content-Length": 2 * MESH.length }).write(MESH, () => response.socket.end()),
      "source_failed", /ended/],
  };
  const from = await files(t, ({ url }, response) => answers[url][0](response));
  const { server, data } = await start(t, ...ALLOWED);
  for (const [path, [, code, words]] of Object.entries(answers))
    assert.match(await refused(await ask(server, from.at(path)), code === "source_failed" ? 422 : 415, code), words);
  const closed = await files(t, obj(MESH));
  await refused(await ask(server, closed.at("/x.obj").replace(/:\d+\//, ":1/")), 422, "source_failed");
  const noise = await raw(t, (socket) => socket.end("\u0000\u0001 no HTTP\r\n\r\n"));
  await refused(await ask(server, noise), 422, "source_failed");
  const endless = await raw(t, (socket) => {
    const talk = () => {
      while (!socket.destroyed && socket.write(`X: ${"a".repeat(1000)}\r\n`));
    };
    socket.on("drain", talk).write("HTTP/1.1 200 OK\r\n");
    talk();
  });
  await refused(await ask(server, endless), 422, "source_failed");
  assert.ok(isClean(data));
});

test("a type that names no mesh is taken where the address ends like one", async (t) => {
  const from = await files(t, ({ url }, response) =>
    response.writeHead(200, url.endsWith("none") ? {} : { "Content-Type": "text/plain; charset=utf-8" }).end(MESH));
  const { server } = await start(t, ...ALLOWED);
  for (const path of ["/x.OBJ", "/x.obj?v=1", "/none"]) await accepted(await ask(server, from.at(path)));
  await refused(await ask(server, from.at("/x?file=y.obj")), 415, "unsupported_media_type");
});

test("a file with parts of its own is refused by their names", async (t) => {
  const gltf = JSON.stringify({
    asset: { version: "2.0" }, buffers: [{ uri: "wall.bin", byteLength: 36 }],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }], nodes: [{ mesh: 0 }], scenes: [{ nodes: [0] }],
  });
  const from = await files(t, (_, response) => response.writeHead(200, { "Content-Type": "model/gltf+json" }).end(gltf));
  const { server } = await start(t, ...ALLOWED);
  const { id } = await accepted(await ask(server, from.at("/scene.gltf")));
  const { problem } = await server.finished(id);
  assert.equal(problem.code, "missing_buffer");
  assert.match(problem.detail, /wall\.bin.*GLB/);
});

test("no more bytes are read than an upload may have", async (t) => {
  let sent = 0;
  const piece = "# comment\n".repeat(1000);
  const from = await files(t, ({ url }, response) => {
    if (url === "/told.obj") return response.writeHead(200, { "Content-Length": 200_001 }).write("v");
    if (url === "/fits.obj") return response.end(MESH.padEnd(100_000, "\n"));
    const talk = () => {
      while (!response.destroyed && response.write(piece, () => (sent += piece.length)));
    };
    response.on("drain", talk);
    talk();
  });
  const { server, data } = await start(t, ...ALLOWED, "--max-body-bytes", "100000");
  await accepted(await ask(server, from.at("/fits.obj")));
  for (const path of ["/told.obj", "/endless.obj"])
    assert.match(await refused(await ask(server, from.at(path)), 413, "body_too_large"), /100000 bytes/);
  const lying = await raw(t, (socket) =>
    socket.end(`HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\n${"v 0 0 0\n".repeat(50_000)}`));
  const { id } = await accepted(await ask(server, lying)); // the first hundred bytes, which are no mesh
  assert.equal((await server.finished(id)).state, "failed");
  assert.ok(sent < 32e6, `${sent} bytes`); // what the kernel holds for both, not what can be sent
  assert.ok(isClean(data));
});

test("a source that comes too slowly ends when its time is over", async (t) => {
  const from = await files(t, async ({ url }, response) => {
    if (url === "/silent.obj") return;
    response.writeHead(200);
    for (let k = 0; !response.destroyed; ++k) {
      response.write("#");
      await sleep(50);
    }
  });
  const { server, data } = await start(t, ...ALLOWED, "--source-seconds", "1");
  for (const path of ["/silent.obj", "/trickle.obj"])
    assert.match(await refused(await ask(server, from.at(path)), 422, "source_failed"), /within the 1 s/);
  assert.ok(isClean(data));
});

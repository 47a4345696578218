// The whole request, upload to result, beside the core's own time in the same job: what HTTP, the
// store, reading and writing add. Usage: node request.mjs FOLDER_OF_UNWRAPD [FACES]
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

const [bin, faces = "100000"] = process.argv.slice(2);
const runs = 7;

/** A bumpy open sheet of about so many triangles as GLB; another one for each k, of which the server
 * knows nothing yet. */
function sheet(faceCount, k) {
  const side = Math.round(Math.sqrt(faceCount / 2)) + k;
  const positions = new Float32Array(3 * (side + 1) ** 2);
  const indices = new Uint32Array(6 * side * side);
  for (let j = 0, at = 0; j <= side; ++j)
    for (let i = 0; i <= side; ++i, at += 3) {
      const [u, v] = [i / side, j / side];
      positions.set([u, v, 0.2 * Math.sin(7 * u + 2 * v) * Math.cos(5 * v)], at);
    }
  for (let j = 0, at = 0; j < side; ++j)
    for (let i = 0; i < side; ++i, at += 6) {
      const a = j * (side + 1) + i;
      indices.set([a, a + 1, a + side + 2, a, a + side + 2, a + side + 1], at);
    }
  return glb(positions, indices);
}

function glb(positions, indices) {
  const bytes = positions.byteLength + indices.byteLength;
  const json = JSON.stringify({
    asset: { version: "2.0" },
    buffers: [{ byteLength: bytes }],
    bufferViews: [
      { buffer: 0, byteLength: positions.byteLength, target: 34962 },
      { buffer: 0, byteOffset: positions.byteLength, byteLength: indices.byteLength, target: 34963 },
    ],
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: "VEC3",
        min: [0, 0, -0.2], max: [1, 1, 0.2] },
      { bufferView: 1, componentType: 5125, count: indices.length, type: "SCALAR" },
    ],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
  });
  const text = json.padEnd(Math.ceil(json.length / 4) * 4);
  const head = Buffer.alloc(20), binHead = Buffer.alloc(8);
  ["glTF", 2, 28 + text.length + bytes, text.length, "JSON"].forEach((word, k) =>
    typeof word === "string" ? head.write(word, 4 * k) : head.writeUInt32LE(word, 4 * k));
  binHead.writeUInt32LE(bytes, 0);
  binHead.write("BIN\0", 4);
  return Buffer.concat([head, Buffer.from(text), binHead, Buffer.from(positions.buffer),
    Buffer.from(indices.buffer)]);
}

/** One job from the first byte up to the last byte down: {whole, core} in ms, and the share of the
 * job that is reading and writing its file. */
async function request(address, body) {
  const start = performance.now();
  const posted = await fetch(`${address}/v1/jobs`, {
    method: "POST",
    headers: {
      "Content-Type": "model/gltf-binary",
      Prefer: "wait=60",
    },
    body,
  });
  const job = await posted.json();
  if (job.state !== "succeeded") throw new Error(JSON.stringify(job));
  await (await fetch(`${address}/v1/jobs/${job.id}/result`)).arrayBuffer();
  const whole = performance.now() - start;
  const { timings_ms: t } = await (await fetch(`${address}/v1/jobs/${job.id}/report`)).json();
  const files = t.read + t.write;
  const stages = Object.entries(t).filter(([name]) => name !== "queue" && name !== "total");
  const core = stages.reduce((sum, [, ms]) => sum + ms, 0) - files;
  return { whole, core, files: files / (core + files) };
}

const data = mkdtempSync(join(tmpdir(), "unwrapd_bench_"));
const server = spawn(join(bin, "unwrapd"), ["--listen", "127.0.0.1:0", "--data", data], {
  stdio: ["ignore", "pipe", "ignore"],
});
const line = await new Promise((resolve) => createInterface(server.stdout).once("line", resolve));
const times = [];
for (let k = 0; k < runs; ++k)
  times.push(await request(line.split(" ").at(-1), sheet(Number(faces), k)));
server.kill("SIGTERM");
await new Promise((resolve) => server.once("exit", resolve));
rmSync(data, { recursive: true });

const middle = times.sort((a, b) => a.whole / a.core - b.whole / b.core)[(runs - 1) / 2];
console.log(`whole request at ${faces} faces: ${middle.whole.toFixed(0)} ms, core alone ` +
  `${middle.core.toFixed(0)} ms, ratio ${(middle.whole / middle.core).toFixed(2)} (asked: 1.1), reading and writing ` +
  `${(100 * middle.files).toFixed(0)} % of the job (asked: 15; median of ${runs})`);

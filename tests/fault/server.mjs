// The real server on a directory, and what the fault tests send, ask and look at. UNWRAPD names the
// binary.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readdirSync, rmdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

const USUAL = [["--listen", "127.0.0.1:0"], ["--admin-listen", "off"], ["--workers", "1"], ["--log-level", "off"]];
export const FAKETIME = `/usr/lib/${process.arch === "arm64" ? "aarch64" : "x86_64"}-linux-gnu/faketime/libfaketime.so.1`;
export const QUICK = "stop.iterations=2";
export const ENDLESS = ["stop.iterations=10000", 100]; // a query and a size: never waited for

/** An OBJ of a bumpy square of size x size quads. */
export function grid(size) {
  const lines = [];
  for (let y = 0; y <= size; y++)
    for (let x = 0; x <= size; x++)
      lines.push(`v ${x / size} ${y / size} ${0.3 * Math.sin((5 * x) / size) * Math.cos((4 * y) / size)}`);
  const at = (x, y) => y * (size + 1) + x + 1;
  for (let y = 0; y < size; y++)
    for (let x = 0; x < size; x++) {
      lines.push(`f ${at(x, y)} ${at(x + 1, y)} ${at(x + 1, y + 1)}`);
      lines.push(`f ${at(x, y)} ${at(x + 1, y + 1)} ${at(x, y + 1)}`);
    }
  return lines.join("\n") + "\n";
}

const servers = new Set();
after(() => servers.forEach((server) => server.process.kill("SIGKILL"))); // of a test that failed

export class Server {
  /** Starts a server on a directory; resolves when it has told its address. */
  static async start(data, ...flags) {
    return Server.startIn({}, data, ...flags);
  }

  /** The same, with more in its environment; what it logs is in `log`. */
  static async startIn(env, data, ...flags) {
    return Server.startAs([], env, data, ...flags);
  }

  /** The same, by another command of the program. */
  static async startAs(command, env, data, ...flags) {
    return Server.startBy([process.env.UNWRAPD, ...command], env, data, ...flags);
  }

  /** The same, by any words that end with those of a program and its command. */
  static async startBy([program, ...words], env, data, ...flags) {
    const server = Object.assign(new Server(), { data });
    const all = [...words, "--data", data, ...flags];
    for (const [flag, value] of USUAL) if (!flags.includes(flag)) all.push(flag, value);
    server.process = spawn(program, all, {
      stdio: ["ignore", "pipe", "pipe"],
      env: { ...process.env, ...env },
    });
    server.log = "";
    server.process.stderr.on("data", (piece) => (server.log += piece));
    servers.add(server);
    server.exited = once(server.process, "exit");
    const lines = createInterface({ input: server.process.stdout });
    const [line] = await Promise.race([once(lines, "line"), server.exited]);
    assert.equal(typeof line, "string", `the server ended before it told its address: ${server.log}`);
    server.url = line.replace("unwrapd listening on ", "");
    return server;
  }

  async submit(query, size = 30) {
    const answer = await fetch(`${this.url}/v1/jobs?${query}`, {
      method: "POST",
      headers: { "Content-Type": "model/obj" },
      body: grid(size),
    });
    assert.equal(answer.status, 202);
    return (await answer.json()).id;
  }

  async job(id) {
    return (await fetch(`${this.url}/v1/jobs/${id}`)).json();
  }

  /** The job, once it is as expected. The longer that takes, the less often it is asked for: to ask costs the job time. */
  async until(id, expected) {
    const begin = Date.now();
    for (; Date.now() < begin + 240_000; await sleep(Math.min(100, 5 + (Date.now() - begin) / 20))) {
      const job = await this.job(id);
      if (expected(job)) return job;
    }
    assert.fail(`job ${id} is still ${JSON.stringify(await this.job(id))}`);
  }

  iterates(id) {
    return this.until(id, (job) => {
      assert.ok(["queued", "running"].includes(job.state), `job ${id} ended before it was seen`);
      return job.state === "running" && job.progress?.iteration > 0;
    });
  }

  finished(id) {
    return this.until(id, (job) => ["succeeded", "failed", "cancelled"].includes(job.state));
  }

  /** Sends a signal; resolves with [exit code, signal]. */
  async end(signal) {
    this.process.kill(signal);
    return this.exited;
  }
}

/** A directory for servers, gone after the test, with those that still work in it. */
export function dataDirectory(t) {
  const data = mkdtempSync(join(tmpdir(), "unwrapd-fault-"));
  t.after(async () => {
    await Promise.all([...servers].filter((server) => server.data.startsWith(data)).map((server) => server.end("SIGKILL")));
    rmSync(data, { recursive: true, force: true });
  });
  return data;
}

/** A small file system of its own, or undefined where this user may not mount one. */
export function smallDisk(t, megabytes) {
  const folder = mkdtempSync(join(tmpdir(), "unwrapd-disk-"));
  const remove = () => rmdirSync(folder);
  try {
    execFileSync("mount", ["-t", "tmpfs", "-o", `size=${megabytes}m`, "tmpfs", folder], { stdio: "ignore" });
  } catch {
    remove();
    return undefined;
  }
  t.after(() => execFileSync("umount", ["-l", folder]));
  t.after(remove);
  return folder;
}

export function filesBelow(directory) {
  return readdirSync(directory, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => entry.name);
}

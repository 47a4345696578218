// Several nodes on one PostgreSQL and one directory, as tests start, kill and ask them.
import { createHash } from "node:crypto";
import { execFileSync } from "node:child_process";
import { mkdirSync, readdirSync, readFileSync } from "node:fs";
import { connect, createServer } from "node:net";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

import { COUNT_ENDS, isInstalled as hasPostgres, NOT_INSTALLED, Postgres } from "../postgres/postgres.mjs";
import { dataDirectory, grid, Server } from "../fault/server.mjs";

export const options = { skip: hasPostgres() ? false : NOT_INSTALLED };
export const LEASE_SECONDS = 3; // the shortest that there is

export class Farm {
  constructor(t, postgres = new Postgres({ sync: false })) {
    this.postgres = postgres;
    t.after(() => postgres.remove());
    this.folder = dataDirectory(t);
    this.shared = join(this.folder, "shared");
    this.blobs = ["--blobs", `dir:${this.shared}`];
    this.url = this.postgres.url();
    this.program = () => [process.env.UNWRAPD]; // of a node, by its name
    this.nodes = new Map();
    t.after(() => this.nodes.forEach((node) => node.process.kill("SIGKILL")));
  }

  /** Starts a node, or starts it again. */
  async start(name, workers, ...flags) {
    return this.startBy(this.url, name, workers, ...flags);
  }

  /** The same, by another way to the database. */
  async startBy(url, name, workers, ...flags) {
    const data = join(this.folder, name);
    mkdirSync(data, { recursive: true });
    const usual = ["--database", url, ...this.blobs, "--workers", String(workers)];
    const lease = ["--lease-seconds", String(LEASE_SECONDS), "--log-level", "warning"];
    const node = await Server.startBy(this.program(name), {}, data, ...usual, ...lease, ...flags);
    node.name = name;
    node.id = readFileSync(join(data, "node"), "utf8");
    this.nodes.set(name, node);
    return node;
  }

  /** Starts a node that listens for no requests. */
  async startWorker(name, ...flags) {
    const data = join(this.folder, name);
    const usual = ["--database", this.url, ...this.blobs, "--lease-seconds", String(LEASE_SECONDS)];
    const node = await Server.startAs(["worker"], {}, data, ...usual, "--log-level", "warning", ...flags);
    node.id = readFileSync(join(data, "node"), "utf8");
    this.nodes.set(name, node);
    return node;
  }

  countEnds() {
    this.postgres.query(COUNT_ENDS);
  }

  query(sql) {
    return this.postgres.query(sql);
  }

  /** The node that runs a job now. */
  nodeOf(job) {
    const id = this.query(`SELECT node FROM jobs WHERE id = '${job}' AND state = 'running'`);
    return [...this.nodes.values()].find((node) => node.id === id);
  }

  addKey(...flags) {
    const args = ["keys", "add", "--data", this.folder, "--database", this.url, ...flags];
    return execFileSync(process.env.UNWRAPD, args, { encoding: "utf8" }).trim().split("\n").at(-1);
  }

  folders(what) {
    return readdirSync(join(this.shared, what)).sort();
  }

  /** Waits until no job waits or runs. */
  async allEnd(seconds = 240) {
    for (const giveUp = Date.now() + seconds * 1000; ; await sleep(100)) {
      const left = this.query("SELECT COUNT(*) FROM jobs WHERE state IN ('queued', 'running')");
      if (left === "0") return;
      if (Date.now() > giveUp) throw new Error(`${left} jobs never end`);
    }
  }
}

/** Whether a program can be run. */
export function isInstalled(program, flag = "--version") {
  try {
    execFileSync(program, [flag], { stdio: "ignore" });
    return true;
  } catch {
    return false;
  }
}

export async function send(node, path, { size = 3, headers = {}, method = "POST", body = grid(size) } = {}) {
  return fetch(node.url + path, { method, headers: { "Content-Type": "model/obj", ...headers }, body });
}

export async function sha256Of(answer) {
  return createHash("sha256").update(Buffer.from(await answer.arrayBuffer())).digest("hex");
}

/** All events of a job from now on, with the milliseconds since `since` of the first and the last. */
export async function watch(node, job, since = Date.now(), headers = {}) {
  const answer = await fetch(`${node.url}/v1/jobs/${job}/events`, { headers });
  let text = "";
  let first;
  for await (const piece of answer.body) {
    first ??= Date.now() - since;
    text += Buffer.from(piece);
  }
  const ids = [...text.matchAll(/^id: (\d+)$/gm)].map((found) => Number(found[1]));
  const names = [...text.matchAll(/^event: (\w+)$/gm)].map((found) => found[1]);
  return { first, last: Date.now() - since, ids, names };
}

/** A way to the database that can be cut: its sessions end, and none begins until it is mended. */
export function cuttableLink(postgres, port) {
  const open = new Set();
  let isCut = false;
  const server = createServer((client) => {
    if (isCut) return client.destroy();
    const upstream = connect(join(postgres.folder, ".s.PGSQL.5432"));
    for (const socket of [client, upstream]) {
      open.add(socket);
      const end = () => [client, upstream].forEach((each) => open.delete(each.destroy()));
      socket.on("error", end).on("close", end);
    }
    client.pipe(upstream).pipe(client);
  });
  server.listen(join(postgres.folder, `.s.PGSQL.${port}`));
  return {
    url: postgres.url(port),
    cut() {
      isCut = true;
      open.forEach((socket) => socket.destroy());
    },
    mend() {
      isCut = false;
    },
    close: () => server.close(),
  };
}

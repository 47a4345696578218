// A second real object store for tests: OpenStack Swift with its S3 API, one server of each kind and
// one copy of each object, all of them on loopback and in a folder of their own.
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, openSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir, userInfo } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

import { freePort } from "../fault/free_port.mjs";
import { ObjectStore } from "./object_store.mjs";

const KINDS = ["account", "container", "object"];
export const NOT_INSTALLED = "swift is not installed (Debian packages swift-proxy, swift-account, swift-container, swift-object)";
export const isInstalled = () => ["proxy", ...KINDS].every((kind) => existsSync(`/usr/bin/swift-${kind}-server`));

const HERE = fileURLToPath(new URL(".", import.meta.url));

const proxy = (more) => `
[pipeline:main]
pipeline = catch_errors gatekeeper cache listing_formats bulk ${more} s3api tempauth copy slo dlo versioned_writes proxy-server
[app:proxy-server]
use = egg:swift#proxy
account_autocreate = true
[filter:tempauth]
use = egg:swift#tempauth
user_test_tester = testing .admin
[filter:s3api]
use = egg:swift#s3api
location = us-east-1
[filter:conditional_puts]
paste.filter_factory = conditional_puts:factory
[filter:cache]
use = egg:swift#memcache
memcache_servers = 127.0.0.1:1
${["catch_errors", "gatekeeper", "listing_formats", "bulk", "copy", "slo", "dlo", "versioned_writes"]
  .map((name) => `[filter:${name}]\nuse = egg:swift#${name}\n`).join("")}`;

const storing = (kind) => `
[pipeline:main]
pipeline = ${kind}-server
[app:${kind}-server]
use = egg:swift#${kind}
`;

export class Swift extends ObjectStore {
  name = "swift";
  key = { id: "test:tester", secret: "testing" };
  #servers = [];

  /** conditionalPuts: it takes them (conditional_puts.py). */
  static async start({ conditionalPuts = false } = {}) {
    const store = new Swift();
    store.more = conditionalPuts ? "conditional_puts" : "";
    store.folder = mkdtempSync(join(tmpdir(), "swift-"));
    mkdirSync(join(store.folder, "devices", "d1"), { recursive: true });
    try {
      for (const kind of KINDS) {
        const port = await freePort();
        store.#makeRing(kind, port);
        store.#servers.push(store.#spawn(kind, port, storing(kind)));
      }
      store.port = await freePort();
      store.endpoint = `http://127.0.0.1:${store.port}`;
      store.startGateway();
      await store.answers();
    } catch (error) {
      store.remove();
      throw error;
    }
    return store;
  }

  #makeRing(kind, port) {
    const ring = (...args) => execFileSync("swift-ring-builder", [join(this.folder, `${kind}.builder`), ...args], { stdio: "ignore" });
    ring("create", "4", "1", "0");
    ring("add", "--region=1", "--zone=1", "--ip=127.0.0.1", `--port=${port}`, "--device=d1", "--weight=1");
    ring("rebalance");
  }

  #spawn(kind, port, config) {
    const settings = {
      bind_ip: "127.0.0.1",
      bind_port: port,
      workers: 0,
      user: userInfo().username,
      swift_dir: this.folder,
      devices: join(this.folder, "devices"),
      mount_check: false,
      fallocate_reserve: 0,
      log_address: join(this.folder, "no-log"),
    };
    const lines = Object.entries(settings).map(([name, value]) => `${name} = ${value}`);
    const file = join(this.folder, `${kind}.conf`);
    writeFileSync(file, `[DEFAULT]\n${lines.join("\n")}\n${config}`);
    const log = openSync(join(this.folder, `${kind}.log`), "a");
    const env = { ...process.env, PYTHONPATH: HERE, PYTHONDONTWRITEBYTECODE: "1" };
    return spawn(`swift-${kind}-server`, [file, "--verbose"], { stdio: ["ignore", log, log], env });
  }

  /** It wants a key. */
  isReady() {
    return true;
  }

  startGateway() {
    this.log = join(this.folder, "proxy.log");
    this.gateway = this.#spawn("proxy", this.port, proxy(this.more));
  }

  remove() {
    for (const server of [this.gateway, ...this.#servers]) server?.kill("SIGKILL");
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

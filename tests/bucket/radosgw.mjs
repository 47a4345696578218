// A real object store for tests: Ceph's radosgw over one monitor and one store in memory, all of
// them on loopback and in a folder of their own.
import { execFileSync, spawn } from "node:child_process";
import { randomUUID } from "node:crypto";
import { existsSync, mkdirSync, mkdtempSync, openSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { freePort } from "../fault/free_port.mjs";
import { ObjectStore, SECONDS_TO_START } from "./object_store.mjs";

const PROGRAMS = ["ceph-mon", "ceph-osd", "ceph", "radosgw", "radosgw-admin"];
export const NOT_INSTALLED = "radosgw is not installed (Debian packages radosgw, ceph-mon, ceph-osd)";
export const isInstalled = () => PROGRAMS.every((name) => existsSync(join("/usr/bin", name)));

export class Radosgw extends ObjectStore {
  name = "radosgw";
  key = { id: "TESTKEY", secret: "test-secret" };

  /** address: where its gateway listens. */
  static async start(address = "127.0.0.1") {
    const store = new Radosgw();
    store.folder = mkdtempSync(join(tmpdir(), "radosgw-"));
    const [port, monitor, monitor1] = [await freePort(), await freePort(), await freePort()];
    store.endpoint = `http://${address}:${port}`;
    store.#configure(`${address}:${port}`, `[v2:127.0.0.1:${monitor},v1:127.0.0.1:${monitor1}]`);
    try {
      store.#startCluster();
      store.startGateway();
      await store.answers();
    } catch (error) {
      store.remove();
      throw error;
    }
    return store;
  }

  #configure(gateway, monitor) {
    this.monitor = monitor;
    this.id = randomUUID();
    this.config = join(this.folder, "ceph.conf");
    for (const name of ["mon", "osd", "rgw", "run"]) mkdirSync(join(this.folder, name));
    const settings = {
      fsid: this.id,
      auth_cluster_required: "none",
      auth_service_required: "none",
      auth_client_required: "none",
      ms_mon_client_mode: "crc",
      ms_client_mode: "crc",
      mon_host: monitor,
      mon_initial_members: "a",
      public_addr: "127.0.0.1",
      cluster_addr: "127.0.0.1",
      run_dir: join(this.folder, "run"),
      admin_socket: join(this.folder, "run", "$name.asok"),
      pid_file: join(this.folder, "run", "$name.pid"),
      log_file: join(this.folder, "$name.log"),
      crash_dir: join(this.folder, "crash"),
      mon_data: join(this.folder, "mon"),
      osd_data: join(this.folder, "osd"),
      rgw_data: join(this.folder, "rgw"),
      keyring: join(this.folder, "keyring"),
      mon_allow_pool_size_one: true,
      mon_warn_on_pool_no_redundancy: false,
      osd_pool_default_size: 1,
      osd_pool_default_min_size: 1,
      osd_pool_default_pg_num: 1,
      osd_pool_default_pgp_num: 1,
      osd_crush_chooseleaf_type: 0,
      osd_objectstore: "memstore",
      memstore_device_bytes: 1 << 29,
      osd_memory_target: 939524096,
      rgw_frontends: `beast endpoint=${gateway} tcp_nodelay=1`,
      rgw_enable_usage_log: false,
    };
    const lines = Object.entries(settings).map(([name, value]) => `${name} = ${value}`);
    writeFileSync(this.config, `[global]\n${lines.join("\n")}\n`);
  }

  #run(program, ...args) {
    const options = { encoding: "utf8", timeout: SECONDS_TO_START * 1000, stdio: ["ignore", "pipe", "pipe"] };
    return execFileSync(program, ["-c", this.config, ...args], options);
  }

  #startCluster() {
    const map = join(this.folder, "monmap");
    execFileSync("monmaptool", ["--create", "--fsid", this.id, "--addv", "a", this.monitor, map], { stdio: "ignore" });
    this.#run("ceph-mon", "--mkfs", "-i", "a", "--monmap", map);
    this.#run("ceph-mon", "-i", "a");
    const osd = randomUUID();
    this.#run("ceph", "osd", "create", osd);
    this.#run("ceph-osd", "-i", "0", "--mkfs", "--osd-uuid", osd);
    this.#run("ceph", "osd", "crush", "add", "osd.0", "1.0", "root=default", "host=test");
    this.#run("ceph-osd", "-i", "0");
    const { id, secret } = this.key;
    const user = ["--uid=test", "--display-name=test", `--access-key=${id}`, `--secret-key=${secret}`];
    this.#run("radosgw-admin", "user", "create", ...user);
  }

  startGateway() {
    this.log = join(this.folder, "gateway.log");
    const log = openSync(this.log, "a");
    this.gateway = spawn("radosgw", ["-d", "-n", "client.rgw", "-c", this.config], { stdio: ["ignore", log, log] });
  }

  remove() {
    this.gateway?.kill("SIGKILL");
    try {
      execFileSync("pkill", ["-9", "-f", this.config]);
    } catch {
      // none was left
    }
    rmSync(this.folder, { recursive: true, force: true });
  }
}

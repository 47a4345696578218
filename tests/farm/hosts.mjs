// Hosts as network namespaces: each has one link to the bridge of the test's own network, where the
// database and the bucket are. A link that is cut loses packets and says so to nobody.
import { execFileSync, spawn, spawnSync } from "node:child_process";

import { Server } from "../fault/server.mjs";

const NEW_SPACES = ["--net", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc"];
const BRIDGE = "farm";
const NETWORK = "10.77.0";
export const HUB = `${NETWORK}.1`;
export const NO_NAMESPACES = "this user may not make network namespaces with bridges (run it as root)";

const run = (program, ...args) => execFileSync(program, args, { encoding: "utf8", stdio: "pipe" });

export function canMakeHosts() {
  const tried = ["ip link add tried type bridge && ip link add one type veth peer name two"];
  return spawnSync("unshare", [...NEW_SPACES, "sh", "-c", ...tried], { stdio: "ignore" }).status === 0;
}

/** Whether this process has a network of its own, with processes that all end with it. */
export const isApart = () => process.env.FARM_APART === "1";

/** Runs a test file apart from the machine's network. What it prints is handed to tell. */
export async function runApart(file, tell) {
  const { NODE_TEST_CONTEXT: _, ...env } = process.env;
  const first = ["sh", "-c", '"$@"; exit $?', "sh"]; // takes in the processes that lose their parents
  const inner = spawn("unshare", [...NEW_SPACES, ...first, process.execPath, "--test-reporter=tap", file], {
    env: { ...env, FARM_APART: "1" },
    stdio: ["ignore", "pipe", "inherit"],
  });
  let text = "";
  inner.stdout.on("data", (piece) => (text += piece));
  const kill = () => inner.kill("SIGKILL");
  process.once("exit", kill);
  const code = await new Promise((resolve) => inner.once("close", resolve));
  process.off("exit", kill);
  for (const [, line] of text.matchAll(/^ *# (?!Subtest|tests|suites|pass|fail|cancelled|skipped|todo|duration)(.*)$/gm)) tell(line);
  return { code, text };
}

export function makeNetwork() {
  run("ip", "link", "set", "lo", "up");
  run("ip", "link", "add", BRIDGE, "type", "bridge");
  run("ip", "address", "add", `${HUB}/24`, "dev", BRIDGE);
  run("ip", "link", "set", BRIDGE, "up");
}

export class Host {
  static #count = 0;

  constructor() {
    const number = ++Host.#count;
    this.address = `${NETWORK}.${number + 1}`;
    this.link = `link${number}`;
    this.keeper = spawn("unshare", ["--net", "sleep", "infinity"], { stdio: "ignore" });
  }

  /** Until the test ends. */
  static async start(t) {
    const host = new Host();
    t.after(() => host.keeper.kill("SIGKILL"));
    const own = run("readlink", "/proc/self/ns/net");
    while (run("readlink", `/proc/${host.keeper.pid}/ns/net`) === own);
    run("ip", "link", "add", host.link, "type", "veth", "peer", "name", "eth0", "netns", String(host.keeper.pid));
    host.mend();
    run("ip", "link", "set", host.link, "up");
    for (const words of [["link", "set", "lo", "up"], ["address", "add", `${host.address}/24`, "dev", "eth0"],
      ["link", "set", "eth0", "up"]]) run(...host.inside("ip", ...words));
    return host;
  }

  /** The words of a command that runs there. */
  inside(...words) {
    return ["nsenter", `--net=/proc/${this.keeper.pid}/ns/net`, ...words];
  }

  cut() {
    run("ip", "link", "set", this.link, "nomaster");
  }

  mend() {
    run("ip", "link", "set", this.link, "master", BRIDGE);
  }
}

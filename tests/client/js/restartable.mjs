// The real server on a port of its own, which can be killed and started again. UNWRAPD is the binary.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

import { freePort } from "../../fault/free_port.mjs";

/** Starts a server: {base, kill, start, end}. */
export async function restartable(...flags) {
  const data = mkdtempSync(join(tmpdir(), "unwrapd-client-"));
  const listen = `127.0.0.1:${await freePort()}`;
  const all = ["--listen", listen, "--admin-listen", "off", "--data", data, "--workers", "1", "--log-level", "off", ...flags];
  let child;
  const start = async () => {
    child = spawn(process.env.UNWRAPD, all, { stdio: ["ignore", "pipe", "inherit"] });
    await once(createInterface({ input: child.stdout }), "line");
  };
  const kill = async (signal = "SIGKILL") => {
    const gone = once(child, "exit");
    child.kill(signal);
    await gone;
  };
  const end = async () => {
    if (child.exitCode === null && child.signalCode === null) await kill();
    rmSync(data, { recursive: true, force: true });
  };
  await start();
  return { base: `http://${listen}`, kill, start, end };
}

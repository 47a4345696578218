// What tests do with a real object store, whichever it is. A subclass has name, endpoint, key and the
// file `log` of its process `gateway`, which startGateway() starts; remove() cleans up.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { setTimeout as sleep } from "node:timers/promises";

export const SECONDS_TO_START = 60;

export class ObjectStore {
  /** Whether an answer to nobody in particular says that it works. */
  isReady(answer) {
    return answer.ok;
  }

  async answers() {
    for (const giveUp = Date.now() + SECONDS_TO_START * 1000; Date.now() < giveUp; await sleep(100)) {
      const answer = await fetch(this.endpoint, { signal: AbortSignal.timeout(5000) }).catch(() => undefined);
      if (answer && this.isReady(answer)) return;
      if (this.gateway.exitCode !== null || this.gateway.signalCode !== null) break;
    }
    throw new Error(`${this.name} does not answer; its log ends with\n${readFileSync(this.log, "utf8").slice(-2000)}`);
  }

  /** As if its machine lost power; the objects stay. */
  async killGateway() {
    const ended = new Promise((resolve) => this.gateway.once("exit", resolve));
    this.gateway.kill("SIGKILL");
    await ended;
  }

  /** Calls the store as the operator does. */
  s3(method, path, ...args) {
    const url = this.endpoint.replace("//", `//${encodeURIComponent(this.key.id)}:${this.key.secret}@`);
    const more = ["--aws-sigv4", "aws:amz:us-east-1:s3", "-H", "x-amz-content-sha256: UNSIGNED-PAYLOAD"];
    return execFileSync("curl", ["-sS", "-X", method, ...more, ...args, url + path]);
  }

  environment() {
    return { AWS_ACCESS_KEY_ID: this.key.id, AWS_SECRET_ACCESS_KEY: this.key.secret };
  }
}

// What tests do with a real object store, whichever it is. A subclass has name, endpoint and key, starts
// its process `gateway` by startGateway(), and cleans up by remove().
import { execFileSync } from "node:child_process";
import { createServer } from "node:net";
import { setTimeout as sleep } from "node:timers/promises";

export const SECONDS_TO_START = 60;

/** A port that nobody has now. */
export function freePort() {
  return new Promise((resolve) => {
    const server = createServer().listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

export class ObjectStore {
  /** Whether an answer to nobody in particular says that it works. */
  isReady(answer) {
    return answer.ok;
  }

  async answers() {
    for (const giveUp = Date.now() + SECONDS_TO_START * 1000; Date.now() < giveUp; await sleep(100)) {
      const answer = await fetch(this.endpoint).catch(() => undefined);
      if (answer && this.isReady(answer)) return;
    }
    throw new Error(`${this.name} does not answer`);
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

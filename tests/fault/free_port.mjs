// Ports for servers that must be told their port before they start. They lie below those that the
// system hands out by itself, so that no connection takes one while its server is starting. Other
// processes of tests draw at random from the same range.
import { randomInt } from "node:crypto";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { createServer } from "node:net";

const LOWEST = 10240; // well-known services are below
const given = new Set();

/** The first of the ports that the system gives to connections and to listeners on port 0. */
function firstOfTheSystem() {
  const [first] = readFileSync("/proc/sys/net/ipv4/ip_local_port_range", "utf8").trim().split(/\s+/).map(Number);
  return first >= LOWEST + 1000 ? first : 32768;
}

async function isFree(port) {
  const server = createServer().listen(port, "127.0.0.1");
  const listens = await once(server, "listening").then(() => true, () => false);
  if (listens) await once(server.close(), "close");
  return listens;
}

/** A port that nobody has now, and no server of this process was told before; with `count`, the first of so many neighbours. */
export async function freePort(count = 1) {
  for (;;) {
    const first = randomInt(LOWEST, firstOfTheSystem() - count);
    const ports = Array.from({ length: count }, (_, i) => first + i);
    if (ports.some((port) => given.has(port))) continue;
    ports.forEach((port) => given.add(port));
    const free = await Promise.all(ports.map(isFree));
    if (free.every(Boolean)) return first;
  }
}

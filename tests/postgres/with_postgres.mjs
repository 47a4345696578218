// Runs a program beside a PostgreSQL server of its own, whose URL is in TEST_POSTGRESQL:
// node with_postgres.mjs [--sync] PROGRAM ARGUMENTS... Exits as the program does, with 77 where PostgreSQL
// is not installed. --sync: commits are on the disk, as in earnest.
import { spawn } from "node:child_process";
import { once } from "node:events";

import { isInstalled, NOT_INSTALLED, Postgres } from "./postgres.mjs";

const SKIPPED = 77;
const args = process.argv.slice(2);
const sync = args[0] === "--sync";
if (sync) args.shift();

if (!isInstalled()) {
  console.log(`skipped: ${NOT_INSTALLED}`);
  process.exit(SKIPPED);
}
const postgres = new Postgres({ sync });
try {
  const env = { ...process.env, TEST_POSTGRESQL: postgres.url() };
  const [code] = await once(spawn(args[0], args.slice(1), { stdio: "inherit", env }), "exit");
  process.exitCode = code ?? 1;
} finally {
  postgres.remove();
}

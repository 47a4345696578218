// The sources of the page keep TypeScript's strict rules: Vite takes types away without a look at them.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdtempSync, rmSync, symlinkSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const root = fileURLToPath(new URL("../..", import.meta.url));
const tools = join(root, "tests/node_modules");

test("the page is sound in its types", { skip: !existsSync(tools) && "run npm ci in tests/" }, (t) => {
  const folder = mkdtempSync(join(tmpdir(), "unwrapd-types-"));
  t.after(() => rmSync(folder, { recursive: true }));
  for (const part of ["client/web/src", "client/web/tsconfig.json", "client/js/src"])
    cpSync(join(root, part), join(folder, part), { recursive: true });
  symlinkSync(tools, join(folder, "node_modules"));
  execFileSync(process.execPath, [join(tools, "openapi-typescript/bin/cli.js"), join(root, "api/openapi.yaml"),
    "--default-non-nullable", "false", "--output", join(folder, "client/js/src/contract.ts")], { stdio: "ignore" });
  const { status, stdout, stderr } = spawnSync(process.execPath, [join(tools, "typescript/bin/tsc"), "-p", join(folder, "client/web")], { encoding: "utf8" });
  assert.deepEqual({ status, stdout, stderr }, { status: 0, stdout: "", stderr: "" });
});

// The package as its users get it: built, packed, unpacked beside the packages that it works with.
// JS_PACKAGE is a folder in which client/js/build.mjs has built it; without, it is built here.
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, symlinkSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const tests = fileURLToPath(new URL("../..", import.meta.url));
const build = join(tests, "../client/js/build.mjs");

/** Installs it into a fresh folder: {folder, load, run, remove}. */
export function install() {
  const folder = mkdtempSync(join(tmpdir(), "unwrapd-package-"));
  const own = join(folder, "node_modules/unwrapd-client");
  const built = process.env.JS_PACKAGE ?? join(folder, "built");
  if (!process.env.JS_PACKAGE) execFileSync(process.execPath, [build, built], { stdio: ["ignore", "ignore", "inherit"] });
  execFileSync("npm", ["pack", built, "--pack-destination", folder], { cwd: folder, stdio: "pipe" });
  mkdirSync(own, { recursive: true });
  execFileSync("tar", ["xf", join(folder, "unwrapd-client-0.1.0.tgz"), "-C", own, "--strip-components=1"]);
  for (const name of ["three", "@gltf-transform", "@types"])
    symlinkSync(join(tests, "node_modules", name), join(folder, "node_modules", name));
  return {
    folder, own,
    load: (name) => import(pathToFileURL(join(own, "dist", name))),
    remove: () => rmSync(folder, { recursive: true, force: true }),
  };
}

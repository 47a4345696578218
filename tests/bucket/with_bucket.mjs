// Runs a program beside a real object store with an empty bucket, whose server it finds in
// TEST_BUCKET: node with_bucket.mjs PROGRAM [ARGUMENT...]. Ends with 77 where none is installed.
import { spawnSync } from "node:child_process";

import { isInstalled, NOT_INSTALLED, Radosgw } from "./radosgw.mjs";

const [program, ...args] = process.argv.slice(2);
if (!isInstalled()) {
  console.log(NOT_INSTALLED);
  process.exit(77);
}
const store = await Radosgw.start();
store.s3("PUT", "/jobs");
const env = { ...process.env, ...store.environment(), TEST_BUCKET: store.endpoint };
const { status } = spawnSync(program, args, { stdio: "inherit", env });
store.remove();
process.exit(status ?? 1);

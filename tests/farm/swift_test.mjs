// A second object store, Swift. Its S3 API has no conditional PUT, so a node refuses it at the start.
// All else that a node asks of a bucket holds there, too.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import test from "node:test";

import { isInstalled, NOT_INSTALLED, Swift } from "../bucket/swift.mjs";
import { useBucket } from "../bucket/use_bucket.mjs";
import { dataDirectory } from "../fault/server.mjs";
import { Farm, options as ofFarm } from "./nodes.mjs";

const options = isInstalled() ? ofFarm : { skip: NOT_INSTALLED };

test("Swift is refused at the start, with the reason", options, async (t) => {
  const store = await Swift.start();
  t.after(() => store.remove());
  store.s3("PUT", "/jobs");
  const farm = new Farm(t);
  const args = ["--data", dataDirectory(t), "--database", farm.url, "--blobs", "s3://jobs", "--s3-endpoint", store.endpoint];
  const start = () => execFileSync(process.env.UNWRAPD, args, { stdio: "pipe", env: { ...process.env, ...store.environment() } });
  assert.throws(start, /cannot keep an object from being written twice \(If-None-Match\).*501, NotImplemented/);
});

test("nodes with a bucket of a Swift that takes conditional PUTs", options, async (t) =>
  useBucket(t, await Swift.start({ conditionalPuts: true })));

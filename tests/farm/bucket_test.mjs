// Nodes whose files are in a bucket of Ceph.
import test from "node:test";

import { isInstalled, NOT_INSTALLED, Radosgw } from "../bucket/radosgw.mjs";
import { useBucket } from "../bucket/use_bucket.mjs";
import { options as ofFarm } from "./nodes.mjs";

const options = isInstalled() ? ofFarm : { skip: NOT_INSTALLED };

test("nodes with a bucket", options, async (t) => useBucket(t, await Radosgw.start()));

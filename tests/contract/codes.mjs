// The codes that no request of this test provokes for certain (what is random may), and why; where
// another test does, which one.

export const kNotProvoked = {
  // the work
  solver_failed: 'no mesh is known whose system cannot be factored; repair and guards come first',
  no_texture_coordinates: 'by packing anew what has no UVs: tests/pipeline',
  does_not_fit: 'by more texels than the pages have: tests/pipeline',
  memory_limit: 'by a worker process that takes all: tests/isolate',
  poison: 'by a server or a worker that dies three times: tests/fault, tests/isolate',
  // the storage
  storage_failed: 'by a disk that fails',
  storage_full: 'by a full disk: tests/fault',
  storage_corrupt: 'by a file that was changed behind the server: tests/fault',
  internal: 'by a mistake of ours, which would be mended',
  // access, which is off in this test
  unauthorized: 'by a server that asks for keys: tests/server',
  forbidden: 'by a key without the scope: tests/server',
  invalid_link: 'by a signed link that was changed: tests/server',
  rate_limited: 'by the quota of a key: tests/server',
  too_many_jobs: 'by the quota of a key: tests/server',
  quota_exceeded: 'by the quota of a key: tests/server',
  webhook_refused: 'by a webhook that is not allowed: tests/server',
};

// The codes that no request of this test provokes for certain (what is random may), and the test that
// does: by servers and workers that end or misbehave, and by disks that are full or forget.

export const kProvokedElsewhere = {
  solver_failed: 'tests/isolate/isolation_test.mjs',  // no mesh is known that does
  memory_limit: 'tests/isolate/isolation_test.mjs',
  poison: 'tests/isolate/isolation_test.mjs',
  internal: 'tests/isolate/isolation_test.mjs',
  source_failed: 'tests/access/sources_test.mjs',
  storage_full: 'tests/fault/storage_test.mjs',
  storage_corrupt: 'tests/fault/storage_test.mjs',
};

// The same of answers: "operation status". The tests that are named judge them by the contract.
export const kShownElsewhere = {
  'getResult 307': 'tests/farm/redirect_test.mjs',  // needs a bucket
};

#!/bin/sh
# run.sh NODE [ARGUMENTS]: runs the contract test, or what the arguments say, by the node that is
# named; or says why it is skipped.
here=$(dirname "$0")
if [ ! -d "$here/../node_modules" ]; then
  echo "Skipped: tests/node_modules is missing; run npm ci in tests/."
  exit 77
fi
node=$1
shift
[ $# -gt 0 ] || set -- "$here/contract.mjs"
exec "$node" "$@"

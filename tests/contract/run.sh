#!/bin/sh
# Runs the contract test with the node that is named, or says why it is skipped.
here=$(dirname "$0")
if [ ! -d "$here/../node_modules" ]; then
  echo "Skipped: tests/node_modules is missing; run npm ci in tests/."
  exit 77
fi
exec "$1" "$here/contract.mjs"

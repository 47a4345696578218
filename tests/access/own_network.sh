#!/bin/sh
# own_network.sh COMMAND...: runs a command where lo has a few public and private addresses, and
# /etc/hosts names for them. 77 where this user may not have a network of its own.
unshare -Urnm true 2>/dev/null && command -v ip >/dev/null || exit 77
exec unshare -Urnm sh -c '
  set -e
  hosts=$(mktemp)
  printf "%s\n" "127.0.0.1 localhost" "93.184.216.34 public.example" "169.254.169.254 metadata.example" \
    "127.0.0.1 loop.example" "::ffff:10.0.0.1 mapped.example" "10.0.0.1 private.example" \
    "93.184.216.34 mixed.example" "10.0.0.1 mixed.example" >"$hosts"
  mount --bind "$hosts" /etc/hosts
  rm "$hosts"
  ip link set lo up
  for address in 93.184.216.34 169.254.169.254 10.0.0.1; do ip addr add "$address/32" dev lo; done
  exec "$@"' own_network "$@"

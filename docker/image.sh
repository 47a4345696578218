#!/usr/bin/env bash
# Builds the container image with whichever of docker, podman and buildah works here, and tries it,
# hardened. Called by ./dev image [build | test].
#   UNWRAPD_IMAGE   its name (unwrapd:latest)
#   UNWRAPD_JOBS    compilers at a time (as many as there are cores)
#   UNWRAPD_DEBIAN  the base image (debian:bookworm-slim), for machines that cannot pull one
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

image=${UNWRAPD_IMAGE:-unwrapd:latest}
debian=${UNWRAPD_DEBIAN:-docker.io/library/debian:bookworm-slim}

say() { printf '== %s\n' "$*"; }
die() { printf 'image: %s\n' "$*" >&2; exit 1; }

# The first of the given engines that is installed and answers: docker may be a client alone.
engine() {
  local one
  for one in "$@"; do
    if command -v "$one" >/dev/null && "$one" info >/dev/null 2>&1; then
      echo "$one"
      return
    fi
  done
  die "none of $* works here; install one (Debian: apt-get install podman)"
}

build() {
  local with version revision
  with=$(engine docker podman buildah)
  version=$(sed -nE 's/^project\(unwrapd VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
  revision=$(git rev-parse --short HEAD 2>/dev/null || echo unknown)
  local arguments=(-f docker/Dockerfile -t "$image" --network host
    --build-arg "DEBIAN=$debian" --build-arg "JOBS=${UNWRAPD_JOBS:-$(nproc)}"
    --build-arg "VERSION=$version" --build-arg "REVISION=$revision")
  # HEALTHCHECK is of docker's format; images are not looked for where there is one already.
  [[ $with == docker ]] || arguments+=(--format docker --ignorefile docker/Dockerfile.dockerignore)
  say "building $image with $with on $debian"
  "$with" build "${arguments[@]}" .
}

try_image() {
  local with
  with=$(engine docker podman)
  UNWRAPD_ENGINE=$with UNWRAPD_IMAGE=$image node --test tests/e2e/image_test.mjs
}

case ${1:-build} in
  build) build ;;
  test) try_image ;;
  *) die "image knows build and test" ;;
esac

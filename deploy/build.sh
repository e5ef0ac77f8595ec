#!/usr/bin/env bash
# Builds the static binaries, and the images portamento-server and portamento-sim-axis around them.
# Usage: deploy/build.sh [TAG]      TAG is `dev` where none is given
set -euo pipefail
cd "$(dirname "$0")/.."
tag=${1:-dev}
triple=x86_64-unknown-linux-gnu

# With --target, the flags are for the binaries alone and not for build scripts and macros.
RUSTFLAGS='-C target-feature=+crt-static' cargo build --locked --release --target "$triple" \
    -p portamento-server -p portamento-sim-axis

# The build context is the two binaries, whatever lies in the checkout.
context=$(mktemp -d)
trap 'rm -rf "$context"' EXIT
mkdir -p "$context/target/$triple/release"
for name in server sim-axis; do
    cp "${CARGO_TARGET_DIR:-target}/$triple/release/portamento-$name" "$context/target/$triple/release/"
done
for name in server sim-axis; do
    # Both builders make the same image; the older one is there wherever an engine is, and says that it is old.
    if ! said=$(DOCKER_BUILDKIT=0 docker build --quiet --file deploy/Dockerfile --target "$name" \
        --tag "portamento-$name:$tag" "$context" 2>&1); then
        echo "$said" >&2
        exit 1
    fi
    echo "portamento-$name:$tag"
done

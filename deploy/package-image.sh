#!/usr/bin/env bash
# Makes an image of a Debian package and the libraries that it needs, on an empty image: nothing is pulled from a registry.
# Usage: deploy/package-image.sh PACKAGE IMAGE PROGRAM      as: haproxy portamento-balancer /usr/sbin/haproxy
# It needs apt and the package lists of a Debian, as every machine has that builds these images.
set -euo pipefail
package=$1 image=$2 program=$3
context=$(mktemp -d)
trap 'rm -rf "$context"' EXIT
mkdir "$context/root" "$context/packages"

# Libraries alone: what programs beside it would need, as a shell, the image does without.
closure() {
    apt-cache depends --recurse --no-recommends --no-suggests --no-conflicts --no-breaks --no-replaces \
        --no-enhances --no-pre-depends "$package" | grep -E '^(lib[^ ]*|zlib1g|'"$package"')$' | sort -u
}
packages=$(closure || true)
if ! grep -qx "$package" <<<"$packages"; then
    echo "no package $package is known here: run apt-get update on a Debian first" >&2
    exit 1
fi
# shellcheck disable=SC2086 — a list of words
(cd "$context/packages" && apt-get download -qq $packages 2>/dev/null)
for deb in "$context"/packages/*.deb; do
    dpkg-deb --extract "$deb" "$context/root"
done
rm -rf "$context"/root/usr/share/{doc,man,locale,lintian} "$context/packages"
mkdir -p "$context/root/etc" "$context/root/tmp"

cat >"$context/Dockerfile" <<DOCKERFILE
FROM scratch
COPY root /
USER 65532:65532
ENTRYPOINT ["$program"]
DOCKERFILE
if ! said=$(DOCKER_BUILDKIT=0 docker build --quiet --tag "$image" "$context" 2>&1); then
    echo "$said" >&2
    exit 1
fi
echo "$image"

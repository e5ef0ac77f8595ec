#!/usr/bin/env bash
# Checks what stands in deploy/ with the programs that read it: HAProxy, promtool, kubectl, and the schemas of Kubernetes. Nothing is
# applied to a cluster.
# It needs a Docker engine, apt and python3; the schemas come with a package of PyPI.
set -euo pipefail
cd "$(dirname "$0")"
export TAG=${TAG:-dev}
for image in "haproxy balancer /usr/sbin/haproxy" "prometheus metrics /usr/bin/prometheus" \
    "kubernetes-client kubectl /usr/bin/kubectl"; do
    read -r package name program <<<"$image"
    docker image inspect "portamento-$name:$TAG" >/dev/null 2>&1 ||
        ./package-image.sh "$package" "portamento-$name:$TAG" "$program"
done

echo '- the balancer'
docker run --rm --network none --volume "$PWD/balancer:/etc/portamento:ro" "portamento-balancer:$TAG" \
    -c -f /etc/portamento/haproxy.cfg
echo '- Prometheus, and what its alerts fire for'
promtool() {
    docker run --rm --network none --user 0 --workdir /tmp --tmpfs /tmp:mode=1777,exec \
        --volume "$PWD/metrics:/etc/portamento:ro" --entrypoint /usr/bin/promtool "portamento-metrics:$TAG" "$@"
}
promtool check config /etc/portamento/prometheus.yml
promtool test rules /etc/portamento/alerts.test.yml

echo '- Kubernetes'
tools=$(mktemp -d)
trap 'rm -rf "$tools"' EXIT
python3 -m venv "$tools/venv"
"$tools/venv/bin/pip" --quiet --disable-pip-version-check install 'kubernetes-validate==1.37.0'
# What `kubectl apply --kustomize` would send. A document a file, as the package reads one alone to its end.
docker run --rm --network none --volume "$PWD/kubernetes:/kubernetes:ro" "portamento-kubectl:$TAG" kustomize /kubernetes |
    (cd "$tools" && csplit --quiet --elide-empty-files --suppress-matched --prefix document- --suffix-format '%02d.yaml' - '/^---$/' '{*}')
# Of cert-manager's kinds the package has no schemas.
built=$(grep --files-without-match '^apiVersion: cert-manager.io/' "$tools"/document-*.yaml)
# shellcheck disable=SC2086 — a list of words
"$tools/venv/bin/kubernetes-validate" --strict $built
# Each image and setting has got the name that kustomization.yaml gives it.
grep --quiet 'image: registry.plant/portamento-server:' $built
test "$(wc -w <<<"$built")" -ge 7

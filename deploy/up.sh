#!/usr/bin/env bash
# Makes every image and brings the plant of compose.yaml up: one command from a fresh clone, where a Docker engine, docker-compose,
# apt and Rust are. Nothing is pulled from a registry of images. `deploy/up.sh down` takes it away again.
set -euo pipefail
cd "$(dirname "$0")"
compose() {
    if docker compose version >/dev/null 2>&1; then
        docker compose --project-name portamento --file compose.yaml "$@"
    else
        docker-compose --project-name portamento --file compose.yaml "$@"
    fi
}
if [ "${1:-up}" = down ]; then
    compose down --volumes
    exit
fi
export TAG=${TAG:-dev}
./build.sh "$TAG"
./package-image.sh haproxy "portamento-balancer:$TAG" /usr/sbin/haproxy
./package-image.sh prometheus "portamento-metrics:$TAG" /usr/bin/prometheus
compose up --detach
cat <<'SAID'

planners behind the balancer   http://127.0.0.1:50050
axes                           http://127.0.0.1:50052, http://127.0.0.1:50053
figures and alerts             http://127.0.0.1:9099
  portamento plan --distance 0.05 --max-velocity 0.25 --max-acceleration 3 --max-jerk 100 \
      --endpoint http://127.0.0.1:50050 --output plan.json
  portamento track --plan plan.json --endpoint http://127.0.0.1:50052 --planner http://balancer:50050
SAID

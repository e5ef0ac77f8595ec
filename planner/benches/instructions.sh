#!/usr/bin/env bash
# Holds the instruction counts of the planner's hot functions against `instructions.txt`, which is written anew with --record.
# A count that is more than TOLERANCE above it fails; one that is as much below it is said, so that it can be recorded.
set -euo pipefail
cd "$(dirname "$0")/../.."

# The C library's allocator and the compiler's patch releases are worth less.
TOLERANCE=0.03
COUNTS=planner/benches/instructions.txt

if ! command -v valgrind >/dev/null; then
    echo 'valgrind is missing, installing it' >&2
    sudo=$([ "$(id -u)" = 0 ] || echo sudo)
    $sudo apt-get update -qq && $sudo apt-get install -qq --yes --no-install-recommends valgrind >/dev/null
fi

binary=$(cargo bench -p portamento-planner --bench instructions --locked --no-run --message-format=json |
    sed -n 's/.*"executable":"\([^"]*instructions-[^"]*\)".*/\1/p')
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
# One dump for each case, in order: counting begins and ends with `measured`, and what was counted is written when it returns.
valgrind --tool=callgrind --callgrind-out-file="$out/dump" --toggle-collect=instructions::measured --dump-after=instructions::measured \
    "$binary" >"$out/cases" 2>"$out/valgrind"
count=0
while read -r name calls; do
    count=$((count + 1))
    total=$(awk '/^(summary|totals):/ { print $2; exit }' "$out/dump.$count")
    echo "$name $((total / calls))"
done <"$out/cases" >"$out/counts"

if [ "${1-}" = --record ]; then
    cp "$out/counts" "$COUNTS"
fi
awk -v tolerance="$TOLERANCE" '
    NR == FNR { before[$1] = $2; next }
    {
        if (!($1 in before)) { verdict = "new: record it"; bad = 1 }
        else if ($2 > before[$1] * (1 + tolerance)) { verdict = "MORE"; bad = 1 }
        else if ($2 < before[$1] * (1 - tolerance)) verdict = "less: record it"
        else verdict = ""
        printf "%-45s %8d  before %8d  %s\n", $1, $2, before[$1], verdict
        delete before[$1]
    }
    END {
        for (name in before) { print name " is counted no more: record it"; bad = 1 }
        exit bad
    }' "$COUNTS" "$out/counts"

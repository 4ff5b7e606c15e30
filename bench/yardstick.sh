#!/usr/bin/env bash
# bench/yardstick.sh: processor seconds of voro++ (Debian's package) on 64,000 uniform random points in the unit cube,
# the median of three runs. Times of one run divided by its yardstick can be compared between machines.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# The points are those of a linear congruential generator (Lewis, Goodman and Miller 1969): the same for every awk.
awk 'function next_one() { state = (state * 16807) % 2147483647; return state / 2147483647 }
  BEGIN {
    state = 20240229
    for (i = 1; i <= 64000; ++i) { x = next_one(); y = next_one(); printf "%d %.9f %.9f %.9f\n", i, x, y, next_one() }
  }' >"$folder/points"
TIMEFORMAT='%U %S'
for _ in 1 2 3; do
  { time voro++ -o 0 1 0 1 0 1 "$folder/points" >/dev/null; } 2>&1 | awk '{ print $1 + $2 }'
done | sort -g | sed -n 2p

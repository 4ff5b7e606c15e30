#!/usr/bin/env bash
# bench/history.sh HISTORY.csv > PAGE.md: the history page of the continuous benchmark, one row a label.
set -euo pipefail
awk -F, '
  BEGIN {
    print "# Instructions of the cutter over time\n"
    print "Made by `bench/history.sh` from `docs/bench-history.csv`; instructions (millions) of one cut with its certificate,"
    print "counted by callgrind, g++-12 release. `.ci/bench` adds a row, and `.github/workflows/bench.yml` runs it for each"
    print "commit on main; a change that takes over 3 % more than `bench/baseline/instructions.csv` fails there.\n"
  }
  NR > 1 {
    if (!($1 in seen)) { seen[$1] = 1; order[++labels] = $1 }
    if (!($2 in known)) { known[$2] = 1; scene[++scenes] = $2 }
    value[$1, $2] = $3
  }
  END {
    row = "| commit |"; rule = "|---|"
    for (s = 1; s <= scenes; ++s) { row = row " " scene[s] " |"; rule = rule "---:|" }
    print row; print rule
    for (l = 1; l <= labels; ++l) {
      row = "| " order[l] " |"
      for (s = 1; s <= scenes; ++s) {
        now = value[order[l], scene[s]]
        before = l > 1 ? value[order[l - 1], scene[s]] : 0
        row = row (now ? sprintf(" %.1f%s |", now / 1e6, before ? sprintf(" (%+.1f %%)", 100 * (now / before - 1)) : "") : " |")
      }
      print row
    }
  }' "$1"

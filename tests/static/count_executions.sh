#!/usr/bin/env bash
# The counter of fuzzing adds up runs of a day, keeps targets apart, and takes no run that says no number.
set -euo pipefail
root=$(cd -- "$(dirname -- "$(readlink -f -- "$0")")/../.." && pwd)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
for script in "$root"/x "$root"/.ci/* "$root"/fuzz/build.sh; do bash -n "$script"; done
git -C "$root" rev-parse -q --verify HEAD >/dev/null 2>&1 || exit 0 # a source archive: no commit to name
count() {
  printf '#5 DONE cov: 9\nstat::number_of_executed_units: %s\nstat::average_exec_per_sec:     7\n' "$2" >"$place/log"
  "$root/.ci/count_executions" "$1" "$place/log" "$place/counted.csv"
}
count fuzz_a 3000000000
count fuzz_b 5
count fuzz_a 12
found=$(cut -d, -f1,2 "$place/counted.csv" | paste -sd' ')
[[ $found == 'target,executions fuzz_a,3000000012 fuzz_b,5' ]] || { printf 'error: counted %s\n' "$found" >&2; exit 1; }
printf 'no figures\n' >"$place/log"
! "$root/.ci/count_executions" fuzz_a "$place/log" "$place/counted.csv" 2>/dev/null || { echo 'error: a run without figures was counted' >&2; exit 1; }
[[ $(cut -d, -f1,2 "$place/counted.csv" | paste -sd' ') == "$found" ]]

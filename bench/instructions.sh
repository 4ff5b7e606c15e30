#!/usr/bin/env bash
# bench/instructions.sh PROGRAM BASELINE [--save] [--history FILE LABEL]: instructions of one cut with its certificate,
# counted by callgrind (which needs no permission of the kernel and repeats to 0.01 %), against the stored baseline.
# Exit code 1 when a scene takes over 3 % more than there, or its answer is wrong.
set -euo pipefail
program=$1 baseline=$2
shift 2
save='' history='' label=''
while (($#)); do
  case $1 in
    --save) save=1 ;;
    --history)
      history=$2 label=$3
      shift 2
      ;;
    *)
      printf 'error: no such option %s\n' "$1" >&2
      exit 2
      ;;
  esac
  shift
done

scenes=(grid-10 gridr-6 persist-13 rect-13 disc-1000 deg-vertex20)
limit=3 # per cent
log=$(mktemp)
table=$(mktemp)
trap 'rm -f "$log" "$table"' EXIT
printf 'scene,instructions,blocks,allocations,allocated_bytes,exact_share\n' >"$table"
failed=0
printf '%-14s %14s %12s %10s %12s %14s %12s\n' scene instructions per_block blocks allocations bytes_per_block baseline
for scene in "${scenes[@]}"; do
  if ! figures=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null --collect-atstart=no \
    --toggle-collect=cleave_bench_measured "$program" "$scene" 2>"$log"); then
    cat "$log" >&2
    printf '%-14s WRONG ANSWER\n' "$scene"
    failed=1 save=''
    continue
  fi
  read -r blocks allocations bytes exact <<<"$figures"
  count=$(sed -n 's/.*Collected : \([0-9]*\).*/\1/p' "$log")
  printf '%s,%s,%s,%s,%s,%s\n' "$scene" "$count" "$blocks" "$allocations" "$bytes" "$exact" >>"$table"
  old=$(awk -F, -v s="$scene" '$1 == s { print $2 }' "$baseline" 2>/dev/null || true)
  against='-'
  if [[ -n $old ]]; then
    against=$(awk -v a="$count" -v b="$old" 'BEGIN { printf "%+.2f %%", 100 * (a / b - 1) }')
    if awk -v a="$count" -v b="$old" -v l="$limit" 'BEGIN { exit !(a > b * (1 + l / 100)) }'; then
      against+=' REGRESSION'
      failed=1
    fi
  fi
  printf '%-14s %14s %12d %10s %12s %14d %12s\n' "$scene" "$count" $((count / blocks)) "$blocks" "$allocations" \
    $((bytes / blocks)) "$against"
  if [[ -n $history ]]; then
    [[ -s $history ]] || printf 'label,scene,instructions,blocks,allocations,allocated_bytes\n' >"$history"
    printf '%s,%s,%s,%s,%s,%s\n' "$label" "$scene" "$count" "$blocks" "$allocations" "$bytes" >>"$history"
  fi
done
if [[ -n $save ]]; then
  mkdir -p "$(dirname "$baseline")"
  cp "$table" "$baseline"
  chmod 644 "$baseline"
  printf 'stored: %s\n' "$baseline"
  exit 0
fi
((failed == 0)) || printf 'error: more than %s %% more instructions than the baseline, or a wrong answer\n' "$limit" >&2
exit "$failed"

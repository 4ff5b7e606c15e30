#!/usr/bin/env bash
# Golden hashes over {gcc, clang} x {-O0, -O3, ASan} x {1, 2, 7 threads}: builds topology_test six times under build/matrix
# and runs its tests of tests/golden/hashes.txt and of threads; all must pass. On demand: a quarter of an hour on two cores.
#
# usage: tests/golden/matrix.sh                            the block systems of tests/golden/hashes.txt
#        tests/golden/matrix.sh --examples [SCENE.toml...] whole programs, whose blocks.hash must agree in every cell
#                                                          (default: single runs in space of examples/*/*.toml and
#                                                          tests/formats/scenes); an hour
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")")
build=$root/build/matrix
jobs=${JOBS:-$(nproc)}
examples=0
if [[ ${1-} == --examples ]]; then
  examples=1
  shift
elif (($#)); then
  echo "usage: tests/golden/matrix.sh [--examples [SCENE.toml...]]" >&2
  exit 2
fi
scenes=("$@")
if ((examples && ${#scenes[@]} == 0)); then
  mapfile -t scenes < <(grep -l '^\[domain\]' "$root"/examples/*/*.toml "$root"/tests/formats/scenes/*.toml |
    xargs grep -L '^\[monte_carlo\]')
fi

# name, compiler, build type (Release is -O3), flags when it is Debug, sanitizers
variants=(
  "gcc-O0|g++-12|Debug|-O0|"
  "gcc-O3|g++-12|Release|-O0|"
  "gcc-asan|g++-12|Debug|-O1|address,undefined"
  "clang-O0|clang++-19|Debug|-O0|"
  "clang-O3|clang++-19|Release|-O0|"
  "clang-asan|clang++-19|Debug|-O1|address,undefined"
)
launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)

hash_of() { # SCENE OUT THREADS PROGRAM
  local summary=$2/summary.json
  "$4" run "$1" -o "$2" --quiet --threads "$3" >/dev/null 2>"$2.err" || { echo "FAILED($?)"; return; }
  sed -n 's/.*"hash": *"\([0-9a-f]*\)".*/\1/p' "$summary" | tr '\n' ' '
}

if ((examples)); then
  target=cleave
  switches=(-DCLEAVE_TESTS=OFF -DCLEAVE_EXAMPLES=OFF)
else
  target=topology_test
  switches=(-DCLEAVE_TESTS=ON -DCLEAVE_EXAMPLES=OFF)
fi

mkdir -p -- "$build"
failed=0
declare -A first
for variant in "${variants[@]}"; do
  IFS='|' read -r name compiler type flags sanitize <<<"$variant"
  cmake -G Ninja -S "$root" -B "$build/$name" -DCMAKE_BUILD_TYPE="$type" -DCMAKE_CXX_COMPILER="$compiler" \
    -DCMAKE_CXX_FLAGS_DEBUG="$flags" -DCLEAVE_SANITIZE="$sanitize" "${switches[@]}" \
    ${launcher[@]+"${launcher[@]}"} >"$build-$name.log" 2>&1 || { echo "$name: cannot be configured, see $build-$name.log"; exit 1; }
  ninja -C "$build/$name" -j "$jobs" "$target" >>"$build-$name.log" 2>&1 || { echo "$name: cannot be built, see $build-$name.log"; exit 1; }
  if ((!examples)); then
    if "$build/$name/bin/topology_test" --gtest_brief=1 --gtest_filter='*Golden*:*Threads*:CanonicalHash*' >>"$build-$name.log" 2>&1; then
      printf '%-11s agrees: %s\n' "$name" "$(grep 'PASSED' "$build-$name.log" | tail -n 1)"
    else
      printf '%-11s DIFFERS or fails, see %s\n' "$name" "$build-$name.log"
      failed=$((failed + 1))
    fi
    continue
  fi
  for scene in "${scenes[@]}"; do
    for threads in 1 2 7; do
      out=$build/out-$name
      rm -rf "$out"
      hash=$(hash_of "$scene" "$out" "$threads" "$build/$name/bin/cleave")
      key=${scene#"$root"/}
      : "${first[$key]:=$hash}"
      if [[ $hash != "${first[$key]}" || $hash == *FAILED* || -z $hash ]]; then
        printf 'DIFFERS %-40s %-11s %s threads: %s, expected %s\n' "$key" "$name" "$threads" "$hash" "${first[$key]}"
        failed=$((failed + 1))
      fi
    done
  done
  printf '%-11s done\n' "$name"
done
if ((!examples)); then
  ((failed == 0)) || { echo "$failed builds differ"; exit 1; }
  echo "all ${#variants[@]} builds agree with tests/golden/hashes.txt on 1, 2 and 7 threads"
  exit 0
fi
for key in "${!first[@]}"; do printf '%-45s %s\n' "$key" "${first[$key]}"; done | sort
((failed == 0)) || { echo "$failed cells differ"; exit 1; }
echo "all ${#variants[@]} builds x 3 thread counts agree on ${#first[@]} scenes"

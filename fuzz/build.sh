#!/usr/bin/env bash
# Fuzz targets for a service that brings its own engine and flags, with the names such services use:
#     CXX=clang++-19 CXXFLAGS="-O1 -fsanitize=address,fuzzer-no-link" LIB_FUZZING_ENGINE=-fsanitize=fuzzer OUT=/out WORK=/tmp/work fuzz/build.sh [TARGET...]
# Writes to OUT for every target (or those named) the program, TARGET_seed_corpus.zip and TARGET.dict.
# Needs clang 17 or later, CMake, Ninja, python3 and the packages that README names for the library.
set -euo pipefail
here=$(cd -- "$(dirname -- "$(readlink -f -- "$0")")" && pwd)
: "${OUT:?the folder for programs and corpora}" "${CXX:=clang++}" "${LIB_FUZZING_ENGINE:=-fsanitize=fuzzer}"
work=${WORK:-$OUT/work}/cleave
mkdir -p "$OUT" "$work"

# Flags are the service's alone: with sanitizers of ours beside them it could not choose.
cmake -S "$here/.." -B "$work" -G Ninja -DCMAKE_CXX_COMPILER="$CXX" -DCMAKE_BUILD_TYPE=None \
  -DCMAKE_CXX_FLAGS="${CXXFLAGS--fsanitize=fuzzer-no-link}" -DCLEAVE_FUZZ=ON -DCLEAVE_FUZZ_ENGINE="$LIB_FUZZING_ENGINE" \
  -DCLEAVE_TESTS=OFF -DBUILD_TESTING=OFF -DCLEAVE_BENCH=OFF -DCLEAVE_EXAMPLES=OFF -DCLEAVE_MPI=OFF >"$work/configure.log"
mapfile -t targets < <(if (($#)); then printf '%s\n' "$@"; else grep . "$work/fuzz/targets.txt"; fi)
ninja -C "$work" "${targets[@]}"

for name in "${targets[@]}"; do
  cp "$work/bin/$name" "$OUT/$name"
  cp "$here/cleave.dict" "$OUT/$name.dict"
  if [[ -d $here/corpus/$name ]]; then
    python3 - "$here/corpus/$name" "$OUT/${name}_seed_corpus.zip" <<'PYTHON'
import pathlib, sys, zipfile

with zipfile.ZipFile(sys.argv[2], "w", zipfile.ZIP_DEFLATED) as corpus:
    for path in sorted(pathlib.Path(sys.argv[1]).iterdir()):
        corpus.writestr(zipfile.ZipInfo(path.name), path.read_bytes())
PYTHON
  fi
done

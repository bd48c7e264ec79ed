#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the part that decides with several compilers, levels of optimisation and thread libraries, and compares
# what each makes of the same meshes, bit for bit. Exit 1 at the first difference.
# Usage: scripts/same-bits.sh      build trees go to build/same-bits
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-deps.sh" --same-bits
jobs=$("$root/scripts/jobs.sh")
# ccache, where it is set, spares more than headers that are parsed once.
pch=ON
[ -z "${CMAKE_CXX_COMPILER_LAUNCHER:-}" ] || pch=OFF

expected=
mkdir -p "$root/build/same-bits"
for variant in "g++ -O1 OPENMP" "g++ -O3 TBB" "clang++ -O2 OPENMP"; do
  read -r compiler level threads <<< "$variant"
  build=$root/build/same-bits/${compiler}${level}-$threads
  cmake -S "$root" -B "$build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="$level -DNDEBUG" -DHFR_$threads=ON -DHFR_TOOL=OFF -DHFR_TESTS=ON -DHFR_PCH=$pch \
    -DHFR_SURFACE=OFF -DHFR_OPENCL=OFF \
    > "$build.log" 2>&1 || { cat "$build.log" >&2; exit 1; }
  cmake --build "$build" --parallel "$jobs" --target same_bits >> "$build.log" 2>&1 \
    || { cat "$build.log" >&2; exit 1; }
  for n in 1 2 3 7 16; do
    found=$("$build/unittests/house/same_bits" $n)
    : "${expected:=$found}"
    if [ "$found" != "$expected" ]; then
      printf 'same-bits: %s with %s threads gives\n%s\ninstead of\n%s\n' "$variant" $n "$found" "$expected" >&2
      exit 1
    fi
  done
  echo "same-bits: $variant: 1, 2, 3, 7 and 16 threads agree"
done

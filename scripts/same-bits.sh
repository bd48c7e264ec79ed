#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the part that decides with several compilers, levels of optimisation and thread libraries, and compares
# what each makes of the same meshes, bit for bit. Exit 1 at the first difference.
# Usage: scripts/same-bits.sh      build trees go to build/same-bits; what is in build/test, or $HFR_BUILD, of
#   scripts/test.sh is brought up to date and stands for g++, where it is there (-O3 with OpenMP)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-deps.sh" --same-bits
jobs=$("$root/scripts/jobs.sh")
# ccache, where it is set, spares more than headers that are parsed once and sources compiled several at a time.
once=ON
[ -z "${CMAKE_CXX_COMPILER_LAUNCHER:-}" ] || once=OFF

# More threads than cores, at times: those that wait for work sleep.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

expected=
# compare VARIANT PROGRAM: exit 1 where it gives something else than the first program with its first number of threads.
compare() {
  local n found
  for n in 1 2 3 7 16; do
    found=$("$2" $n)
    : "${expected:=$found}"
    if [ "$found" != "$expected" ]; then
      printf 'same-bits: %s with %s threads gives\n%s\ninstead of\n%s\n' "$1" $n "$found" "$expected" >&2
      exit 1
    fi
  done
  echo "same-bits: $1: 1, 2, 3, 7 and 16 threads agree"
}

tests=${HFR_BUILD:-$root/build/test}
variants=("g++ -O1 OPENMP" "g++ -O3 TBB" "clang++ -O2 OPENMP")
if [ -e "$tests/unittests/house/same_bits" ]; then
  cmake --build "$tests" --parallel "$jobs" --target same_bits > /dev/null
  expected=$("$tests/unittests/house/same_bits" 1)  # of other numbers of threads its test house.same_bits tells
  echo "same-bits: scripts/test.sh is what the others are compared with"
  variants=("clang++ -O2 TBB")
fi
mkdir -p "$root/build/same-bits"
for variant in "${variants[@]}"; do
  read -r compiler level threads <<< "$variant"
  build=$root/build/same-bits/${compiler}${level}-$threads
  cmake -S "$root" -B "$build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="$level -DNDEBUG" -DHFR_$threads=ON -DHFR_TOOL=OFF -DHFR_TESTS=ON -DHFR_PCH=$once \
    -DCMAKE_UNITY_BUILD=$once -DHFR_SURFACE=OFF -DHFR_OPENCL=OFF \
    > "$build.log" 2>&1 || { cat "$build.log" >&2; exit 1; }
  cmake --build "$build" --parallel "$jobs" --target same_bits >> "$build.log" 2>&1 \
    || { cat "$build.log" >&2; exit 1; }
  compare "$variant" "$build/unittests/house/same_bits"
done

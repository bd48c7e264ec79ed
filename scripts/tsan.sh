#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the tests of threads under ThreadSanitizer: with clang and its OpenMP runtime, which tells the sanitizer
# what it does, and with g++ and oneTBB. (g++'s own OpenMP runtime gives false reports.) Exit 1 on a report.
# Usage: scripts/tsan.sh      build trees go to build/tsan-*
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-deps.sh" --same-bits
jobs=$("$root/scripts/jobs.sh")
export TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=1 exitcode=66"
# The annotations of clang's OpenMP runtime; it finds them by itself only where they lie in a system folder.
archer=$(clang++ -print-file-name=libarcher.so)
[ -f "$archer" ] || archer=$(find -L /usr/lib/llvm-*/lib -name libarcher.so 2> /dev/null | head -n 1)
if [ -z "$archer" ]; then
  echo "tsan: libarcher.so is missing, without which every parallel loop is reported; it comes with libomp-dev" >&2
  exit 1
fi
export OMP_TOOL_LIBRARIES=$archer
mkdir -p "$root/build"

for variant in "clang++ OPENMP" "g++ TBB"; do
  read -r compiler threads <<< "$variant"
  build=$root/build/tsan-$threads
  cmake -S "$root" -B "$build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" -DHFR_SANITIZE=thread -DHFR_$threads=ON -DHFR_TOOL=OFF \
    -DHFR_TESTS=ON > "$build.log" 2>&1 || { cat "$build.log" >&2; exit 1; }
  cmake --build "$build" --parallel "$jobs" --target test_Parallel test_Scheduler test_Remesh >> "$build.log" 2>&1 \
    || { tail -n 50 "$build.log" >&2; exit 1; }
  for run in "Parallel *" "Scheduler *" "Remesh ImproveThreads.*"; do
    read -r layer filter <<< "$run"
    echo "tsan: $variant, $layer"
    "$build/unittests/$layer/test_$layer" --gtest_brief=1 --gtest_filter="$filter"
  done
done
echo "tsan: no report"

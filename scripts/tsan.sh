#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the tests of threads under ThreadSanitizer, with clang and its OpenMP runtime, which tells the sanitizer
# what it does. (g++'s runtime, and a oneTBB that is not instrumented itself, give false reports.) Exit 1 on a
# report.
# Usage: scripts/tsan.sh      the build tree goes to build/tsan
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

build=$root/build/tsan
cmake -S "$root" -B "$build" -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" -DHFR_SANITIZE=thread -DHFR_TOOL=OFF -DHFR_TESTS=ON
cmake --build "$build" --parallel "$jobs" --target test_Parallel test_Scheduler test_Remesh test_Paranoid
for run in "Parallel *" "Scheduler *" "Remesh ImproveThreads.*" "Paranoid *"; do
  read -r layer filter <<< "$run"
  echo "tsan: $layer"
  "$build/unittests/$layer/test_$layer" --gtest_brief=1 --gtest_filter="$filter"
done
echo "tsan: no report"

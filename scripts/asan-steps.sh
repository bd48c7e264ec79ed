#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A thousand steps of the turning body under AddressSanitizer and UndefinedBehaviorSanitizer, and how much memory
# they hold on the way. Exit 1 on a report, where a step is worse than the example promises, or where the second
# half of the steps needs 5 % more memory than the first.
# Usage: scripts/asan-steps.sh [N STEPS]     6 N³ cells about, 8 and 1000 by default; builds in build/asan
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/asan
cells=${1:-8}
steps=${2:-1000}
mkdir -p "$build"
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g" \
  -DHFR_SANITIZE=address,undefined -DHFR_TOOL=OFF -DHFR_TESTS=ON > "$build/configure.log"
cmake --build "$build" --parallel "$("$root/scripts/jobs.sh")" --target example_turning_body
# What is freed waits 8 MiB long before it is handed out again: the figures are those of the program.
export ASAN_OPTIONS="quarantine_size_mb=8:detect_leaks=1:halt_on_error=1" UBSAN_OPTIONS="halt_on_error=1"
export OMP_WAIT_POLICY=passive
memory=$build/asan-steps.kib
: > "$memory"
"$build/examples/example_turning_body" "$cells" "$steps" &
program=$!
while kill -0 "$program" 2> /dev/null; do
  awk '/^VmRSS:/ {print $2}' "/proc/$program/status" 2> /dev/null >> "$memory" || true
  sleep 0.5
done
wait "$program"
awk '{kib[NR] = $1}
  END {
    half = int(NR / 2)
    for (i = 1; i <= NR; ++i) if (i <= half) { if (kib[i] > first) first = kib[i] } else if (kib[i] > second) second = kib[i]
    printf "asan-steps: %d steps, no report; resident memory at most %.1f MiB in the first half of the time, %.1f in the second (%d samples)\n",
      steps, first / 1024, second / 1024, NR
    exit second > 1.05 * first
  }' steps="$steps" "$memory"

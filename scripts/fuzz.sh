#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs random meshes with random options for a while; see docs/fuzzing.md. Exit 1 where there are findings.
# Usage: scripts/fuzz.sh [MINUTES] [FROM]     60 minutes, cases from number 1 on
#   HFR_BUILD=FOLDER  where to build; default build/test in the checkout
#   JOBS=N            worker processes; default as for building
# Findings stand in build/fuzz.log, one a line; files of them and of what they shrink to in build/fuzz.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${HFR_BUILD:-$root/build/test}
minutes=${1:-60}
from=${2:-1}

if [ ! -e "$build/CMakeCache.txt" ]; then
  "$root/scripts/install-deps.sh"
  cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O3 -g1" \
    -DHFR_TESTS=ON
fi
cmake --build "$build" --parallel "$("$root/scripts/jobs.sh")" --target hfr_fuzz
fuzz=$build/unittests/Fuzz/hfr_fuzz
log=$root/build/fuzz.log
status=0
"$fuzz" --from "$from" --minutes "$minutes" --slow 5 --jobs "${JOBS:-$("$root/scripts/jobs.sh")}" |
  tee "$log" || status=$?
sed -nE 's/^case ([0-9]+): .*/\1/p' "$log" | sort -nu | head -20 | while read -r number; do
  timeout 300 "$fuzz" --case "$number" --shrink --write "$root/build/fuzz" || true
done
exit "$status"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs every parallel algorithm and every pipeline under a scheduler that shuffles and interleaves on purpose
# (unittests/Shuffle), against the bits of one thread: what scripts/test.sh does for 200 seeds. A difference is
# printed with the seed that repeats it.
# Usage: scripts/shuffle.sh [SEEDS [FIRST]]     default 10000 seeds from 1 on; exit 1 on a difference
#   HFR_BUILD=FOLDER  where to build; default build/test in the checkout
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${HFR_BUILD:-$root/build/test}
seeds=${1:-10000}
first=${2:-1}
case $seeds$first in *[!0-9]*) echo "shuffle: usage: scripts/shuffle.sh [SEEDS [FIRST]]" >&2; exit 1 ;; esac
n_jobs=$("$root/scripts/jobs.sh")
if [ ! -f "$build/CMakeCache.txt" ]; then
  cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O3 -g1" \
    -DHFR_TESTS=ON
fi
cmake --build "$build" --parallel "$n_jobs" --target test_Shuffle

logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT
# part FIRST END: the seeds of one process.
part() {
  if ! HFR_SHUFFLE_FIRST=$1 HFR_SHUFFLE_SEEDS=$(($2 - $1)) "$build/unittests/Shuffle/test_Shuffle" \
      --gtest_brief=1 --gtest_filter='*Shuffled*' > "$logs/$1" 2>&1; then
    cat "$logs/$1"
    touch "$logs/failed"
  fi
}
end=$((first + seeds))
step=250
for ((at = first; at < end; at += step)); do
  while [ "$(jobs -rp | wc -l)" -ge "$n_jobs" ]; do wait -n; done
  part "$at" "$((at + step < end ? at + step : end))" &
done
wait
if [ -e "$logs/failed" ]; then
  echo "shuffle: not all of the $seeds seeds from $first on gave the bits of one thread" >&2
  exit 1
fi
echo "shuffle: $seeds seeds from $first on, no difference"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Operations of the kernel and single operators at random on random complexes, with a check in full after each; see
# docs/fuzzing.md. Exit 1 where something is wrong.
# Usage: scripts/soak.sh [OPERATIONS [FROM]]     1,000,000 operations, complexes from number 1 on
#   HFR_BUILD=FOLDER  where to build; default build/test in the checkout
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${HFR_BUILD:-$root/build/test}
if [ ! -e "$build/CMakeCache.txt" ]; then
  "$root/scripts/install-deps.sh"
  cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O3 -g1" \
    -DHFR_TESTS=ON
fi
cmake --build "$build" --parallel "$("$root/scripts/jobs.sh")" --target hfr_soak
exec "$build/unittests/Fuzz/hfr_soak" --operations "${1:-1000000}" --from "${2:-1}"

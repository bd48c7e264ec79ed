#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, builds everything with assertions on, and runs every test.
# Usage: scripts/test.sh [OPTION ...]     options go to ctest, e.g. -R HalfFace
#   HFR_WERROR=1      warnings are errors
#   HFR_BUILD=FOLDER  where to build; default build/test in the checkout
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${HFR_BUILD:-$root/build/test}
werror=OFF
case ${HFR_WERROR:-0} in 1 | ON | on | true) werror=ON ;; esac

"$root/scripts/install-deps.sh"
jobs=$("$root/scripts/jobs.sh")
# Optimised as a release is, but without -DNDEBUG; line numbers only, because full debug data doubles time and size of a build.
# ccache, where it is set, spares more than headers that are parsed once and sources compiled several at a time.
pch=TESTS unity=ON
[ -z "${CMAKE_CXX_COMPILER_LAUNCHER:-}" ] || pch=OFF unity=OFF
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O3 -g1" \
  -DHFR_TESTS=ON -DHFR_WERROR=$werror -DHFR_PCH=$pch -DCMAKE_UNITY_BUILD=$unity \
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
cmake --build "$build" --parallel "$jobs"
ctest --test-dir "$build" --output-on-failure --parallel "$jobs" "$@"

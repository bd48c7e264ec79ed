#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the examples of moving meshes at full size; the tests run them small. Minutes on two cores.
# Usage: examples/run_all.sh [BUILD [FOLDER]]     BUILD: where the project was built, build/release by default;
#                                                 FOLDER: for the turning body's .vtu files, which ParaView opens
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/release}
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}
if [ ! -x "$build/examples/example_turning_body" ]; then
  echo "run_all: no examples in $build; cmake -S $root -B $build -DHFR_TESTS=ON && cmake --build $build" >&2
  exit 1
fi
run() {
  echo "== $*"
  "$build/examples/example_$1" "${@:2}"
}
run turning_body 26 200 ${2:+"$2"}
run pulsating_cavity 20 40
run falling_ball 16 60
if [ -x "$build/examples/example_heat_equation" ]; then run heat_equation 32 60; fi  # wants Eigen
run flap_in_channel 16 60

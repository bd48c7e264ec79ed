#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the examples of moving meshes at full size; the tests run them small. Minutes on two cores.
# Usage: examples/run_all.sh [BUILD [FOLDER]]     BUILD: where the project was built, build/release by default;
#                                                 FOLDER: for pictures of four of them, NAME.png, and the .vtu files
#                                                 that they are made of; those of the turning body are a series
#   SMALL=1   as small as the tests run them
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
# NAME FULL-SIZE FULL-STEPS SMALL-SIZE SMALL-STEPS
run_with_picture() {
  local size=("$2" "$3")
  if [ -n "${SMALL:-}" ]; then size=("$4" "$5"); fi
  run "$1" "${size[@]}" ${folder:+"$folder/$1"}
  if [ -z "$folder" ]; then return; fi
  local meshes=("$folder/$1/before.vtu" "$folder/$1/after.vtu")
  if [ "$1" = turning_body ]; then
    meshes=("$folder/$1/step_0000.vtu" "$folder/$1/$(printf 'step_%04d.vtu' "${size[1]}")")
  fi
  "$build/apps/hfremesh/hfremesh" report "${meshes[@]}" --png "$folder/$1.png" --png-width 1200 --quiet
}
folder=${2:-}
run_with_picture turning_body 26 200 10 40
run_with_picture pulsating_cavity 20 40 10 20
run_with_picture falling_ball 16 60 10 20
run_with_picture flap_in_channel 16 60 8 30
if [ -n "${SMALL:-}" ]; then exit 0; fi
if [ -x "$build/examples/example_heat_equation" ]; then run heat_equation 32 60; fi  # wants Eigen

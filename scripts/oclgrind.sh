#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the device passes on small meshes in oclgrind, which simulates a device and reports accesses out of
# bounds and data races.
# Usage: scripts/oclgrind.sh [TOOL [OPTION ...]]    default build/test/apps/hfremesh/hfremesh; options go to
#   oclgrind. --uninitialized reports commit_mates in oclgrind 21.10, which has not been explained yet.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
tool=${1:-$root/build/test/apps/hfremesh/hfremesh}
options=("${@:2}")
command -v oclgrind > /dev/null ||
  { echo "oclgrind: not installed; scripts/install-deps.sh --dev installs it" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export HFR_CACHE_DIR=$work/cache
# The run-time library of oclgrind in place of a loader: it knows one device, its own.
library=$(ls /usr/lib/oclgrind/liboclgrind-rt.so "$(dirname "$(command -v oclgrind)")"/../lib*/liboclgrind-rt.so 2> /dev/null | head -n 1 || true)

# run NAME GENERATE-ARGUMENTS -- IMPROVE-ARGUMENTS: the same on the processor, and in oclgrind.
run() {
  local name=$1 generate=() code=0
  shift
  while [ "$1" != -- ]; do generate+=("$1"); shift; done
  shift
  "$tool" generate "${generate[@]}" -o "$work/$name.mesh" -q
  "$tool" "$work/$name.mesh" -o "$work/cpu.mesh" -q "$@" || code=$?
  [ $code -le 4 ] || exit $code
  code=0
  # Without optimisation: oclgrind 21.10 does not know every instruction that it leads to.
  HFR_OPENCL_LIBRARY=$library oclgrind --build-options -cl-opt-disable --data-races "${options[@]}" --log "$work/log" \
    "$tool" "$work/$name.mesh" -o "$work/device.mesh" -q --device opencl "$@" || code=$?
  [ $code -le 4 ] || { cat "$work/log"; exit $code; }
  if [ -s "$work/log" ]; then
    echo "oclgrind: $name: $(grep -c . "$work/log") lines:" >&2
    head -n 60 "$work/log" >&2
    exit 1
  fi
  cmp "$work/cpu.mesh" "$work/device.mesh"
  echo "oclgrind: $name: no fault, same bits"
}

run box box --n 4 4 4 --jitter 0.25 -- --iterations 1 --ops edge,face,smooth
run groups box --n 3 3 3 --jitter 0.25 -- --iterations 1 --ops edge,face,smooth --work-group 32
run paper box --n 3 3 3 --jitter 0.3 -- --compat jpdc2013 --iterations 1 --ops smooth

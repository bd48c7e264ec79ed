#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the device passes on small meshes in oclgrind, which simulates a device and reports accesses out of
# bounds, data races and reads of what was never written. Exit 1 at the first report or difference of output.
# Usage: scripts/oclgrind.sh [TOOL LOADER]
#   TOOL    default build/test/apps/hfremesh/hfremesh
#   LOADER  what unittests/Device/WatchedLoader.cc becomes; default beside the tests of the same build
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
tool=${1:-$root/build/test/apps/hfremesh/hfremesh}
loader=${2:-$root/build/test/unittests/Device/libhfr_watched_loader.so}
command -v oclgrind > /dev/null ||
  { echo "oclgrind: not installed; scripts/install-deps.sh installs it" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export HFR_CACHE_DIR=$work/cache
# run NAME OPTION...: the same on the processor, and in oclgrind.
run() {
  local name=$1 code=0
  shift
  "$tool" "$work/$name.mesh" -o "$work/cpu.mesh" -q "$@" || code=$?
  [ $code -le 4 ] || exit $code
  code=0
  # Without optimisation: oclgrind 21.10 does not know every instruction that it leads to.
  HFR_OPENCL_LIBRARY=$loader timeout 300 oclgrind --build-options -cl-opt-disable --data-races \
    --uninitialized --log "$work/log" \
    "$tool" "$work/$name.mesh" -o "$work/device.mesh" -q --device opencl "$@" || code=$?
  [ $code -le 4 ] || { head -n 60 "$work/log" >&2; exit $code; }
  if [ -s "$work/log" ]; then
    echo "oclgrind: $name: $(grep -c . "$work/log") lines:" >&2
    head -n 60 "$work/log" >&2
    exit 1
  fi
  cmp "$work/cpu.mesh" "$work/device.mesh"
  echo "oclgrind: $name: no fault, same bits"
}

box() {
  local name=$1
  shift
  "$tool" generate box "$@" -o "$work/$name.mesh" -q
}
box box --n 4 4 4 --jitter 0.25
run box --iterations 1 --ops edge,face,node,smooth --bulk-nodes --min-cells 1
box groups --n 3 3 3 --jitter 0.25 --regions 2
run groups --iterations 1 --ops edge,face,node,smooth --bulk-nodes --min-cells 1 --work-group 32
box paper --n 3 3 3 --jitter 0.3
run paper --compat jpdc2013 --iterations 1 --ops smooth
# An edge in a ring of twelve cells, close to one of them, so that removing it pays.
awk 'BEGIN {
  n = 12; turn = 2 * atan2(0, -1) / n; x = 0.955 * cos(turn / 2); y = 0.955 * sin(turn / 2)
  print "MeshVersionFormatted 2\nDimension 3\nVertices\n" n + 2
  for (i = 0; i < n; ++i) print cos(turn * i), sin(turn * i), 0, 0
  print x, y, -1, 0
  print x, y, 1, 0
  print "Tetrahedra\n" n
  for (i = 0; i < n; ++i) print n + 1, n + 2, i + 1, (i + 1) % n + 1, 0
  print "End"
}' > "$work/ring.mesh"
run ring --iterations 1 --ops edge
# A vertex with 34 cells, close to one of its neighbours, so that removing it pays; and where it would cost too
# many cells.
awk 'BEGIN {
  n = 17; turn = 2 * atan2(0, -1) / n
  print "MeshVersionFormatted 2\nDimension 3\nVertices\n" n + 3
  for (i = 0; i < n; ++i) print cos(turn * i), sin(turn * i), 0, 0
  print "0 0 -1 0\n0 0 1 0\n0 0 0.99 0"
  print "Tetrahedra\n" 2 * n
  for (i = 0; i < n; ++i) {
    print n + 3, (i + 1) % n + 1, i + 1, n + 1, 0
    print n + 3, i + 1, (i + 1) % n + 1, n + 2, 0
  }
  print "End"
}' > "$work/star.mesh"
for group in 1 32; do
  run star --iterations 1 --ops node --bulk-nodes --work-group $group
  run star --iterations 1 --ops node --bulk-nodes --work-group $group --min-cells 1
done

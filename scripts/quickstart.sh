#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# From a fresh checkout to a repaired mesh: installs what is missing, builds the tool, generates the cavity of
# the paper (607,200 cells, 48 of them inverted), repairs it and prints the table of before and after.
# Leaves quickstart-out/cavity.mesh and quickstart-out/cavity_repaired.mesh in the checkout.
# Usage: scripts/quickstart.sh [OPTION ...]     options go to hfremesh, e.g. -j 1
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/quickstart
out=$root/quickstart-out

"$root/scripts/install-deps.sh" --tool
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DHFR_TESTS=OFF -DHFR_PCH=ON
cmake --build "$build" --target hfremesh_tool --parallel "$("$root/scripts/jobs.sh")"

tool=$build/apps/hfremesh/hfremesh
mkdir -p "$out"
"$tool" generate cavity --n 44 46 50 --jitter 0.201 --sigma 0.08 --amplitude 0.27877 --seed 2013 \
  -o "$out/cavity.mesh"
"$tool" "$out/cavity.mesh" -o "$out/cavity_repaired.mesh" "$@"
echo "The meshes: $out/cavity.mesh and $out/cavity_repaired.mesh"

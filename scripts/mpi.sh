#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what several ranks take, builds hfremesh-mpi and its tests, runs these with 1 to 4 ranks, and one mesh through
# hfremesh and hfremesh-mpi.
# Usage: scripts/mpi.sh [BUILD]     default build/mpi
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/mpi}
"$root/scripts/install-deps.sh" --mpi
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DHFR_MPI=ON -DHFR_TESTS=ON > /dev/null
cmake --build "$build" --target test_Distributed hfremesh_tool hfremesh_mpi_tool --parallel "$("$root/scripts/jobs.sh")"
ctest --test-dir "$build/unittests/Distributed" --output-on-failure

if [ "$(id -u)" -eq 0 ]; then export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$build/apps/hfremesh/hfremesh" generate cavity -o "$work/in.mesh" --quiet
"$build/apps/hfremesh/hfremesh" "$work/in.mesh" -o "$work/one.mesh" --min-dihedral 15 --quiet
for n in 1 2 3 4; do
  mpirun --oversubscribe --bind-to none -n "$n" "$build/apps/hfremesh/hfremesh-mpi" "$work/in.mesh" -o "$work/many.mesh" \
    --min-dihedral 15 --share-from 0 --quiet
  cmp "$work/one.mesh" "$work/many.mesh"
done
echo "mpi: the same bits on 1 to 4 ranks"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what several ranks take, builds hfremesh-mpi and its tests, runs these with 1 to 4 ranks, installs a copy and
# links it, and sends one mesh through hfremesh and hfremesh-mpi.
# Usage: scripts/mpi.sh [--mpich] [BUILD]     default build/mpi, with --mpich build/mpich
#   --mpich       MPICH instead of the MPI that mpicxx is of; without PT-Scotch, which Debian has for Open MPI alone
#   HFR_WERROR=1  warnings are errors
# Called by .ci/ranks, too.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
name=mpi run=(mpirun --oversubscribe --bind-to none) options=()
if [ "${1:-}" = --mpich ]; then
  shift
  name=mpich run=(mpiexec.mpich -bind-to none)
  options=(-DMPI_CXX_COMPILER=mpicxx.mpich -DMPIEXEC_EXECUTABLE="$(command -v mpiexec.mpich || echo /usr/bin/mpiexec.mpich)"
    -DHFR_PTSCOTCH=OFF)
fi
build=${1:-$root/build/$name}
werror=OFF
case ${HFR_WERROR:-0} in 1 | ON | on | true) werror=ON ;; esac

"$root/scripts/install-deps.sh" "--$name"
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DHFR_MPI=ON -DHFR_TESTS=ON -DHFR_WERROR=$werror \
  "${options[@]}" > /dev/null
cmake --build "$build" --target test_Distributed example_solver_on_ranks hfremesh_tool hfremesh_mpi_tool hfremesh_c \
  hfremesh_manual --parallel "$("$root/scripts/jobs.sh")"
ctest --test-dir "$build" --output-on-failure --parallel 4 -R '^Distributed\.'  # those on ranks one by one
ctest --test-dir "$build/unittests/install" --output-on-failure -R '^install\.(prefix|mpi)'

if [ "$(id -u)" -eq 0 ]; then export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$build/apps/hfremesh/hfremesh" generate cavity -o "$work/in.mesh" --quiet
"$build/apps/hfremesh/hfremesh" "$work/in.mesh" -o "$work/one.mesh" --min-dihedral 15 --quiet
for n in 1 2 3 4; do
  "${run[@]}" -n "$n" "$build/apps/hfremesh/hfremesh-mpi" "$work/in.mesh" -o "$work/many.mesh" \
    --min-dihedral 15 --share-from 0 --quiet
  cmp "$work/one.mesh" "$work/many.mesh"
done
echo "mpi: the same bits on 1 to 4 ranks"

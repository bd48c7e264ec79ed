#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs PETSc, builds libhfremesh_petsc and its tests, runs these with 1 to 3 ranks, and the examples in C and Python.
# Usage: scripts/petsc.sh [BUILD]     default build/petsc
#   HFR_WERROR=1  warnings are errors
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/petsc}
werror=OFF
case ${HFR_WERROR:-0} in 1 | ON | on | true) werror=ON ;; esac
"$root/scripts/install-deps.sh" --petsc
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DHFR_MPI=ON -DHFR_PETSC=ON -DHFR_TESTS=ON \
  -DHFR_WERROR=$werror > /dev/null
cmake --build "$build" --target hfremesh_petsc test_petsc example_petsc_adapt_label example_petsc_adapt_metric hfremesh_tool hfremesh_mpi_tool \
  hfremesh_petsc_tool hfremesh_c hfremesh_manual --parallel "$("$root/scripts/jobs.sh")"
ctest --test-dir "$build" --output-on-failure -R '^(petsc\.|install\.(prefix|petsc))'
echo "petsc: the library for -dll_prepend is $build/bindings/petsc/libhfremesh_petsc.so"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The table of docs/distributed.md: hfremesh-mpi on several ranks beside hfremesh on one thread, goal 15 degrees.
# Usage: bench/distributed.sh BUILD MESH ...     needs HFR_MPI; RANKS="1 2 3 4", SECONDS_EACH=120, ARGUMENTS,
#        MPI_ARGUMENTS="--share-from 0"
# Prints for each mesh and number of ranks: whether the output is the same to the last bit, seconds of improve, and
# what was left to rank 0 (lines "gather" in the report are hand-overs).
set -euo pipefail
build=$1
shift
ranks=${RANKS:-"1 2 3 4"}
seconds=${SECONDS_EACH:-120}
read -ra arguments <<< "${ARGUMENTS:---min-dihedral 15}"
read -ra more <<< "${MPI_ARGUMENTS:---share-from 0}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "$(id -u)" -eq 0 ]; then export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; fi

# figures JSON: seconds and hand-overs.
figures() {
  python3 - "$1" << 'PYTHON'
import json, sys
run = json.load(open(sys.argv[1]))
passes = run.get("passes", [])
gathers = sum(1 for p in passes if p.get("op") == "gather")
print(f"{run['seconds']['improve']:.2f} s, {gathers} hand-overs")
PYTHON
}

for mesh in "$@"; do
  name=$(basename "$mesh")
  timeout "$seconds" "$build/apps/hfremesh/hfremesh" "$mesh" -o "$work/one.mesh" "${arguments[@]}" --threads 1 --quiet \
    --json "$work/one.json" 2> /dev/null || [ $? -eq 3 ] || [ $? -eq 4 ] || { echo "$name: no reference"; continue; }
  echo "$name: shared memory $(figures "$work/one.json")"
  for n in $ranks; do
    code=0
    timeout "$seconds" mpirun --oversubscribe --bind-to none -n "$n" "$build/apps/hfremesh/hfremesh-mpi" "$mesh" \
      -o "$work/many.mesh" "${arguments[@]}" "${more[@]}" --quiet --json "$work/many.json" > "$work/log" 2>&1 || code=$?
    if [ "$code" -eq 124 ]; then
      echo "$name: $n ranks: no end within $seconds s"
    elif cmp -s "$work/one.mesh" "$work/many.mesh"; then
      echo "$name: $n ranks: same bits, $(figures "$work/many.json")"
    else
      echo "$name: $n ranks: DIFFERS, code $code"
    fi
    rm -f "$work/many.mesh"
  done
done

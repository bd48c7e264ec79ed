#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A mesh that no rank could hold alone: each rank may take so much memory (ulimit -v). Shows that one rank and
# hfremesh fail within it, and that several together generate the mesh, write it, read it, improve it, check it and
# write it again. Prints seconds and memory as hfremesh-mpi tells them.
# Usage: bench/beyond_one_rank.sh BUILD [CUBES [RANKS [MB_A_RANK [DEGREES]]]]
#   defaults: 150 cubes a side, which are 20,250,000 cells; 4 ranks; 1500 MB of address space each; 15 degrees.
#   OUT=DIR    keeps the files there; otherwise they are in a temporary folder and go
#   STAGES=1   improves all cells by all stages of a run, not only those below so many degrees
#   COMPARE=1  also runs hfremesh without a limit and compares the bytes: takes the memory that the limit forbids
set -euo pipefail
build=$1 cubes=${2:-150} ranks=${3:-4} limit=${4:-1500} degrees=${5:-15}
mpi=$build/apps/hfremesh/hfremesh-mpi tool=$build/apps/hfremesh/hfremesh
how=(--min-dihedral "$degrees") whole=(--min-dihedral "$degrees" --polish-only)
if [ "${STAGES:-0}" = 1 ]; then how=(--all-stages) whole=(); fi
grid=(--generate "$cubes" "$cubes" "$cubes" --jitter 0.2)
if [ "$(id -u)" -eq 0 ]; then export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; fi
out=${OUT:-$(mktemp -d)}
[ -n "${OUT:-}" ] || trap 'rm -rf "$out"' EXIT

# Of each process, mpirun's own included.
limited() {
  local n=$1
  shift
  mpirun --oversubscribe --bind-to none -n "$n" bash -c "ulimit -v $((limit * 1000)); exec \"\$@\"" _ "$mpi" parts "$@"
}
fails() {
  echo "--- $1: has to fail within $limit MB"
  shift
  if "$@" 2>&1 | tail -n 3; then
    echo "beyond_one_rank: it did not fail: ask for more cubes or less memory" >&2
    exit 1
  fi
}

fails "one rank" limited 1 "${grid[@]}" -o "$out/alone.vtu" "${how[@]}"
fails hfremesh bash -c "ulimit -v $((limit * 1000)); \"\$@\" && \"$tool\" \"$out/alone.vtu\" -o \"$out/alone.vtu\" \
  ${whole[*]} --threads 1" _ \
  "$tool" generate cavity --n "$cubes" "$cubes" "$cubes" --amplitude 0 --jitter 0.2 -o "$out/alone.vtu" --quiet
rm -f "$out/alone.vtu"
echo "--- $ranks ranks, $limit MB each: generate and write"
limited "$ranks" "${grid[@]}" -o "$out/bad.pvtu"
echo "--- $ranks ranks, $limit MB each: read, improve, check, write"
limited "$ranks" "$out/bad.pvtu" -o "$out/good.pvtu" "${how[@]}"
echo "--- $ranks ranks, $limit MB each: generate, improve, check, write one file"
limited "$ranks" "${grid[@]}" -o "$out/good.vtu" "${how[@]}"
echo "--- $ranks ranks, $limit MB each: write one file, read it by ranges, improve, check, write"
limited "$ranks" "${grid[@]}" -o "$out/bad.vtu" > /dev/null
limited "$ranks" "$out/bad.vtu" -o "$out/again.vtu" "${how[@]}"
cmp "$out/good.vtu" "$out/again.vtu"
if [ "${COMPARE:-0}" = 1 ]; then
  echo "--- hfremesh without a limit"
  "$tool" generate cavity --n "$cubes" "$cubes" "$cubes" --amplitude 0 --jitter 0.2 -o "$out/whole.vtu" --quiet
  "$tool" "$out/whole.vtu" -o "$out/whole.vtu" "${whole[@]}" --threads 1 --quiet
  cmp "$out/whole.vtu" "$out/good.vtu"
  echo "beyond_one_rank: the same bytes"
fi

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes what the tool makes of many meshes in many modes: one line a run, with mesh, options, exit code, cells
# and the SHA-256 of the output file. Two files of two builds are compared with `diff`: a change that is meant to
# keep every result keeps every line.
# Usage: scripts/results.sh OUT [--tool FILE] [--below N] [--jobs N] [--only WORD]
#   OUT          the file to write, sorted; at the end, and only when every run has ended
#   --tool FILE  a tool that was built before; by default build/release is brought up to date and its tool taken
#   --below N    leave out meshes of more than N cells; by default none is left out
#   --jobs N     runs at a time; default: one for each core. Every run has one thread.
#   --only WORD  only meshes whose name holds the word
# Meshes: what `hfremesh generate` makes in the shapes of the tests, and each file below ../shared/meshes where
# that folder is there (HFR_TEST_MESHES names another). Exit codes 5 and 6 and every code above make the script
# fail, since such a run depends on the machine; so does a run that a signal ended.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out='' tool='' below=1000000000 jobs=$(nproc) only=''
while [ $# -gt 0 ]; do
  case $1 in
    --tool) tool=$2; shift 2 ;;
    --below) below=$2; shift 2 ;;
    --jobs) jobs=$2; shift 2 ;;
    --only) only=$2; shift 2 ;;
    -*) sed -n '6,14s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 1 ;;
    *) out=$1; shift ;;
  esac
done
[ -n "$out" ] || { sed -n '6,14s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 1; }
if [ -z "$tool" ]; then
  cmake -S "$root" -B "$root/build/release" -DCMAKE_BUILD_TYPE=Release -DHFR_TESTS=OFF > /dev/null
  cmake --build "$root/build/release" --target hfremesh_tool --parallel "$("$root/scripts/jobs.sh")" > /dev/null
  tool=$root/build/release/apps/hfremesh/hfremesh
fi
meshes=${HFR_TEST_MESHES:-$root/../shared/meshes}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

generate() {  # NAME SHAPE OPTION...
  local name=$1
  shift
  "$tool" generate "$@" -q -o "$work/$name.mesh"
  printf '%s\t%s\n' "generated/$name" "$work/$name.mesh" >> "$work/list"
}
: > "$work/list"
generate box box --n 6 6 6 --jitter 0.25
generate box_tangled box --n 8 8 8 --jitter 0.6 --seed 3
generate box_very_tangled box --n 8 8 8 --jitter 1.0 --seed 5
generate box_of_one_layer box --n 12 12 1 --jitter 0.25
generate box_of_two_regions box --n 6 6 6 --regions 2 --jitter 0.3
generate slab box --n 20 20 2 --high 10 10 0.1 --jitter 0.2
generate cavity20k cavity --n 14 15 16 --jitter 0.201 --sigma 0.08 --amplitude 0.27877 --seed 2013
generate cavity_sheared cavity --n 10 10 10 --field bulk-shear --amplitude 0.5 --seed 7
generate ball ball --n 8 --jitter 0.3
generate ball_tangled ball --n 8 --jitter 0.9 --seed 9
generate cylinder cylinder --n 4 12 --jitter 0.2
generate cylinder_wrung cylinder --n 4 12 --wring 50
generate cylinder_folded cylinder --n 4 12 --wring 70
generate fandisk fandisk --n 6 6 4 --jitter 0.2
generate cavity607k cavity --n 44 46 50 --jitter 0.201 --sigma 0.08 --amplitude 0.27877 --seed 2013
if [ -d "$meshes" ]; then
  # A TetGen mesh is named by its .ele file alone; its .node file goes with it.
  find -L "$meshes" -type f \( -name '*.mesh' -o -name '*.msh' -o -name '*.vtk' -o -name '*.vtu' -o -name '*.ele' \) |
    sort | while read -r file; do printf '%s\t%s\n' "${file#"$meshes"/}" "$file"; done >> "$work/list"
else
  echo "results: there is no $meshes; generated meshes only" >&2
fi

# The boundary of a few shapes, as triangles alone.
triangles() {  # NAME FILE
  python3 - "$2" "$work/$1.off" << 'PYTHON'
import sys
from collections import Counter

words = open(sys.argv[1], encoding="ascii").read().split()
at = words.index("Vertices")
n = int(words[at + 1])
points = [words[at + 2 + 4 * i:at + 5 + 4 * i] for i in range(n)]
at = words.index("Tetrahedra")
cells = [[int(v) - 1 for v in words[at + 2 + 5 * i:at + 6 + 5 * i]] for i in range(int(words[at + 1]))]
faces = Counter()
seen = {}
for a, b, c, d in cells:
    for face in ((b, c, d), (a, d, c), (a, b, d), (a, c, b)):
        faces[tuple(sorted(face))] += 1
        seen[tuple(sorted(face))] = face
outer = [seen[key] for key, count in faces.items() if count == 1]
used = {v: i for i, v in enumerate(sorted({v for face in outer for v in face}))}
with open(sys.argv[2], "w", encoding="ascii") as file:
    print(f"OFF\n{len(used)} {len(outer)} 0", file=file)
    for v in used:
        print(*points[v], file=file)
    for face in outer:
        print(3, *(used[v] for v in face), file=file)
PYTHON
  printf '%s\t%s\n' "triangles/$1" "$work/$1.off" >> "$work/triangles"
}
: > "$work/triangles"
for name in box ball fandisk cylinder; do triangles "$name" "$work/$name.mesh"; done

kSmall=25000  # cells up to which --min-dihedral max is run
modes=(
  ""
  "--min-dihedral 15"
  "--surface flat"
  "--surface flat --min-dihedral 20"
  "--surface free"
  "--compat jpdc2013 --iterations 3"
  "--bulk-nodes"
  "--coarsen"
)
: > "$work/runs"
while IFS=$'\t' read -r name file; do
  case $name in *"$only"*) ;; *) continue ;; esac
  # A file that cannot be read gives an empty count: its runs are in the list with the exit code they end with.
  cells=$("$tool" stats "$file" --json - 2> /dev/null |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["meshes"][0]["statistics"]["cells"])' 2> /dev/null || echo 0)
  [ "$cells" -le "$below" ] || continue
  for mode in "${modes[@]}"; do printf '%s\t%s\t%s\n' "$name" "$file" "$mode" >> "$work/runs"; done
  if [ "$cells" -le $kSmall ]; then printf '%s\t%s\t%s\n' "$name" "$file" "--min-dihedral max" >> "$work/runs"; fi
done < "$work/list"
while IFS=$'\t' read -r name file; do
  case $name in *"$only"*) ;; *) continue ;; esac
  for mode in "" "--min-angle 25" "--surface flat"; do printf '%s\t%s\t%s\n' "$name" "$file" "$mode" >> "$work/runs"; done
done < "$work/triangles"

run_one() {  # number of the line
  local name file mode code=0 result extension
  IFS=$'\t' read -r name file mode <<< "$(sed -n "$1p" "$work/runs" | sed 's/\t$/\t-/')"
  [ "$mode" != - ] || mode=''
  extension=${file##*.}
  [ "$extension" = off ] || extension=mesh
  result=$work/out$1.$extension
  # shellcheck disable=SC2086  # the options are words
  "$tool" "$file" -o "$result" -q -j 1 $mode > /dev/null 2>&1 || code=$?
  local hash=-
  if [ -e "$result" ]; then hash=$(sha256sum < "$result" | cut -d ' ' -f 1); fi
  rm -f "$result"
  printf '%s\t%s\t%s\t%s\n' "$name" "${mode:-default}" "$code" "$hash" > "$work/line$1"
}
export -f run_one
export tool work
seq "$(wc -l < "$work/runs")" | xargs -P "$jobs" -I{} bash -c 'run_one {}'
cat "$work"/line* | sort > "$work/all"
mv "$work/all" "$out"
echo "results: $(wc -l < "$out") runs, in $out"
bad=$(awk -F '\t' '$3 == 5 || $3 == 6 || $3 > 7 && $3 != 130' "$out")
[ -z "$bad" ] || { printf 'results: these runs ended otherwise than they should:\n%s\n' "$bad" >&2; exit 1; }

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks the rules between the folders of src/ (docs/building.md names them):
#   - a folder includes only itself and the folders before it;
#   - only src/Parallel knows OpenMP and oneTBB;
#   - nothing in src/ prints, exits or aborts;
#   - every header in kernels/ is listed in kernels/CMakeLists.txt, every source in its folder's CMakeLists.txt;
#   - apps/ and examples/ use public headers only.
# Usage: scripts/check-layers.sh [ROOT]     prints one line for each fault; exit 1 when there is one.
set -euo pipefail
root=${1:-$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)}
cd "$root"

order=(Parallel HalfFace Quality IO Operators Surface Scheduler Device Remesh)
any_layer=$(IFS='|'; echo "${order[*]}")
faults=$(mktemp)
trap 'rm -f "$faults"' EXIT

# sources FOLDER ...: our files below the folders.
sources() {
  local folder
  for folder in "$@"; do
    if [ -d "$folder" ]; then find "$folder" -type f \( -name '*.cc' -o -name '*.hh' -o -name '*.h' -o -name '*.cl' \); fi
  done | LC_ALL=C sort
}

# code FILE: its lines as NUMBER:TEXT, without // comments and without strings (whose text may say anything).
code() { sed -E 's/\\"//g; s/"[^"]*"/""/g; s,//.*,,' "$1" | grep -n '' || true; }

# Folders above each folder.
allowed=()
for layer in "${order[@]}"; do
  allowed+=("$layer")
  mine=$(IFS='|'; echo "${allowed[*]}")
  for file in $(sources "src/$layer"); do
    { grep -nE "^ *# *include +[<\"]($any_layer)/" "$file" || true; } |
      { grep -vE "^[0-9]+: *# *include +[<\"]($mine)/" || true; } |
      sed -E "s|^([0-9]+):(.*)|$file:\1: $layer stands below what it includes: \2|" >> "$faults"
  done
done
for file in $(sources kernels); do
  { grep -nE "^ *# *include +[<\"]($any_layer)/" "$file" || true; } |
    sed -E "s|^([0-9]+):(.*)|$file:\1: kernels stand below what they include: \2|" >> "$faults"
done

for file in $(sources src kernels apps); do
  case $file in src/Parallel/*) continue ;; esac
  { grep -nE '^ *# *(include *[<"](omp\.h|tbb/|oneapi/tbb)|pragma +omp)|omp_[a-z_]+\(|tbb::' "$file" || true; } |
    sed -E "s|^([0-9]+):(.*)|$file:\1: only src/Parallel knows the thread library: \2|" >> "$faults"
done

prints='(std::|[^A-Za-z0-9_:.>]|^)(cout|cerr|clog|printf|fprintf|vprintf|vfprintf|puts|fputs|putchar|perror)[^A-Za-z0-9_]|fmt::print'
ends='(std::|[^A-Za-z0-9_:.>]|^)(exit|_Exit|quick_exit|abort|terminate)[[:space:]]*\('
for file in $(sources src kernels); do
  code "$file" | { grep -E "^[0-9]+:.*($prints|$ends)" || true; } |
    sed -E "s|^([0-9]+):(.*)|$file:\1: src/ neither prints nor ends the program: \2|" >> "$faults"
done

for file in kernels/*.h; do
  [ -e "$file" ] || continue
  grep -qwF -- "$(basename "$file")" kernels/CMakeLists.txt ||
    echo "$file: not listed in kernels/CMakeLists.txt, so not installed" >> "$faults"
done
for file in $(sources src | grep '\.cc$'); do
  grep -qwF -- "$(basename "$file")" "$(dirname "$file")/CMakeLists.txt" ||
    echo "$file: not listed in $(dirname "$file")/CMakeLists.txt" >> "$faults"
done

for file in $(sources apps examples); do
  { grep -noE "^ *# *include +[<\"]($any_layer)/[A-Za-z0-9_]+\.hh" "$file" || true; } |
    sed -E 's|^([0-9]+):.*[<"](.*)$|\1 \2|' | while read -r line header; do
      [ "$header" = HalfFace/Config.hh ] && continue
      grep -qwF -- "$(basename "$header")" "src/$(dirname "$header")/CMakeLists.txt" 2>/dev/null ||
        echo "$file:$line: $header is not a public header" >> "$faults"
    done
done

cat "$faults"
if [ -s "$faults" ]; then
  echo "check-layers: $(wc -l < "$faults") faults" >&2
  exit 1
fi
echo "check-layers: no fault in $(sources src kernels apps examples | wc -l) files"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks the rules between the folders of src/ (docs/building.md names them):
#   - a folder includes only itself and the folders before it;
#   - only src/Parallel knows OpenMP and oneTBB;
#   - nothing in src/ prints, exits or aborts;
#   - every header in kernels/ is listed in kernels/CMakeLists.txt, every source and header in its folder's
#     CMakeLists.txt;
#   - nor does anything in bindings/;
#   - git tracks no file of more than a mebibyte: outputs of runs come in by mistake;
#   - public headers, apps/, bindings/ and examples/ include public headers only, by the names that users have for
#     them: hfremesh/LAYER/NAME.hh.
# Usage: scripts/check-layers.sh [ROOT]     prints one line for each fault; exit 1 when there is one.
set -euo pipefail
root=${1:-$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)}
cd "$root"

order=(Parallel HalfFace Quality IO Transfer Operators Surface Scheduler Device Remesh Distributed)
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
    { grep -nE "^ *# *include +[<\"](hfremesh/)?($any_layer)/" "$file" || true; } |
      { grep -vE "^[0-9]+: *# *include +[<\"](hfremesh/)?($mine)/" || true; } |
      sed -E "s|^([0-9]+):(.*)|$file:\1: $layer stands below what it includes: \2|" >> "$faults"
  done
done
for file in $(sources kernels); do
  { grep -nE "^ *# *include +[<\"](hfremesh/)?($any_layer)/" "$file" || true; } |
    sed -E "s|^([0-9]+):(.*)|$file:\1: kernels stand below what they include: \2|" >> "$faults"
done

for file in $(sources src kernels apps bindings); do
  case $file in src/Parallel/*) continue ;; esac
  { grep -nE '^ *# *(include *[<"](omp\.h|tbb/|oneapi/tbb)|pragma +omp)|omp_[a-z_]+\(|tbb::' "$file" || true; } |
    sed -E "s|^([0-9]+):(.*)|$file:\1: only src/Parallel knows the thread library: \2|" >> "$faults"
done

prints='(std::|[^A-Za-z0-9_:.>]|^)(cout|cerr|clog|printf|fprintf|vprintf|vfprintf|puts|fputs|putchar|perror)[^A-Za-z0-9_]|fmt::print'
ends='(std::|[^A-Za-z0-9_:.>]|^)(exit|_Exit|quick_exit|abort|terminate)[[:space:]]*\('
for file in $(sources src kernels bindings); do
  code "$file" | { grep -E "^[0-9]+:.*($prints|$ends)" || true; } |
    sed -E "s|^([0-9]+):(.*)|$file:\1: ${file%%/*}/ neither prints nor ends the program: \2|" >> "$faults"
done

for file in kernels/*.h; do
  [ -e "$file" ] || continue
  grep -qwF -- "$(basename "$file")" kernels/CMakeLists.txt ||
    echo "$file: not listed in kernels/CMakeLists.txt, so not installed" >> "$faults"
done
for file in $(sources src | grep -E '\.(cc|hh)$'); do
  grep -qwF -- "$(basename "$file")" "$(dirname "$file")/CMakeLists.txt" ||
    echo "$file: not listed in $(dirname "$file")/CMakeLists.txt" >> "$faults"
done

# public_headers CMAKELISTS: what it has after HEADERS of hfr_layer() or FILES of hfr_public_headers().
public_headers() {
  [ -e "$1" ] || return 0
  sed -E 's/#.*//; s/[()]/ & /g' "$1" | awk -v folder="$(basename "$(dirname "$1")")" '
    { for (i = 1; i <= NF; ++i)
        if ($i == "HEADERS" || $i == "FILES") on = 1
        else if ($i ~ /^([A-Z_]+|\))$/) on = 0
        else if (on && $i ~ /\.hh?$/) print folder "/" $i }'
}
public=$(mktemp)
trap 'rm -f "$faults" "$public"' EXIT
for list in kernels/CMakeLists.txt src/*/CMakeLists.txt; do public_headers "$list"; done | LC_ALL=C sort -u > "$public"

# only_public FILE: what it includes of the project is public and has the name that users have for it.
only_public() {
  { grep -noE "^ *# *include +[<\"](hfremesh/)?($any_layer|kernels)/[A-Za-z0-9_]+\.hh?" "$1" || true; } |
    sed -E 's|^([0-9]+):.*[<"](.*)$|\1 \2|' | while read -r line header; do
      if ! grep -qxF -- "${header#hfremesh/}" "$public"; then
        echo "$1:$line: ${header#hfremesh/} is not a public header"
      elif [ "$header" = "${header#hfremesh/}" ]; then
        echo "$1:$line: users know $header as hfremesh/$header"
      fi
    done >> "$faults"
}
for file in $(sources apps bindings examples); do only_public "$file"; done
while read -r header; do
  if [ -e "src/$header" ]; then only_public "src/$header"; fi
done < "$public"

if [ -e .git ]; then
  { git ls-files -z | xargs -0 wc -c -- 2> /dev/null || true; } |
    awk '$1 > 1048576 && $2 != "total" { size = $1; sub(/^ *[0-9]+ /, ""); print $0 ": no file of " size " bytes is tracked" }' \
      >> "$faults"
fi

cat "$faults"
if [ -s "$faults" ]; then
  echo "check-layers: $(wc -l < "$faults") faults" >&2
  exit 1
fi
echo "check-layers: no fault in $(sources src kernels apps bindings examples | wc -l) files"

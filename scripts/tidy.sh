#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs clang-tidy 14 with the checks of .clang-tidy.
# Usage: scripts/tidy.sh [FILE.cc ...]     default: every source of src/ and apps/
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/tidy
tidy=clang-tidy-14
if ! command -v "$tidy" > /dev/null; then
  echo "tidy: $tidy is missing; scripts/install-deps.sh --dev installs it" >&2
  exit 1
fi

files=()
for file in "$@"; do files+=("$(realpath "$file")"); done
cd "$root"
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER=clang++ -DHFR_TESTS=OFF \
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON > /dev/null
cmake --build "$build" --target hfr_kernel_arguments > /dev/null
if [ ${#files[@]} -eq 0 ]; then
  mapfile -t files < <(find "$root/src" "$root/apps" -name '*.cc' | LC_ALL=C sort)
fi
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(scripts/jobs.sh)" \
  "$tidy" --quiet -p "$build" --warnings-as-errors='*'
echo "tidy: ${#files[@]} files"

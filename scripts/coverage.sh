#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds with gcov, runs the tests and prints how many lines of src/ they run, by folder.
# Exit 1 when a test fails or less than 90 % of the lines are run.
# Usage: scripts/coverage.sh [OPTION ...]     options go to ctest
#        scripts/coverage.sh --folder IO      one folder of src/ by its own tests, file by file; 95 % are wanted then
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/coverage
goal=90
if ! command -v gcovr > /dev/null; then
  echo "coverage: gcovr is missing; scripts/install-deps.sh --dev installs it" >&2
  exit 1
fi

cd "$root"
jobs=$(scripts/jobs.sh)
cmake --preset coverage
if [ "${1:-}" = --folder ]; then
  folder=$2
  cmake --build --preset coverage --parallel "$jobs" --target "test_$folder"
  find "$build" -name '*.gcda' -delete
  "$build/unittests/$folder/test_$folder" --gtest_brief=1
  gcovr --root "$root" --filter "src/$folder/" --object-directory "$build" --fail-under-line 95 "$build"
  exit
fi
cmake --build --preset coverage --parallel "$jobs"
find "$build" -name '*.gcda' -delete  # counts of an earlier run
ctest --preset coverage --parallel "$jobs" "$@"

report=$build/coverage.csv
gcovr --root "$root" --filter 'src/' --object-directory "$build" --csv "$report" "$build"
folders=$(awk -F, '
  NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
  {
    split($column["filename"], part, "/")
    folder = part[1] "/" part[2]
    lines[folder] += $column["line_total"]
    run[folder] += $column["line_covered"]
  }
  END { for (f in lines) print f, lines[f], run[f] }' "$report" | LC_ALL=C sort)
awk -v goal="$goal" '
  function percent(run, lines) { return lines ? 100 * run / lines : 0 }
  BEGIN { printf "%-18s %8s %8s %8s\n", "folder", "lines", "run", "%" }
  {
    printf "%-18s %8d %8d %8.1f\n", $1, $2, $3, percent($3, $2)
    lines += $2
    run += $3
  }
  END {
    printf "line coverage of src/: %.1f %%\n", percent(run, lines)
    exit percent(run, lines) < goal
  }' <<< "$folders"

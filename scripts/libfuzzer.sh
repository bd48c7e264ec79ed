#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the targets of libFuzzer with AddressSanitizer and UndefinedBehaviorSanitizer and runs them; see
# docs/fuzzing.md. Exit 1 where there are findings.
# Usage: scripts/libfuzzer.sh [MINUTES [TARGET ...]]     1 minute each; all targets
#   targets: read-EXTENSION (mesh meshb node ele face ovm msh vtk vtu stl obj off ply), round_trip, improve
#   HFR_BUILD=FOLDER  where to build; default build/fuzzers in the checkout
# Inputs that reach new code are kept in FOLDER/corpus and are where the next run begins; findings in
# FOLDER/findings. One that is mended goes to unittests/LibFuzzer/kept/TARGET, whose files are tests.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${HFR_BUILD:-$root/build/fuzzers}
minutes=${1:-1}
[ $# -eq 0 ] || shift
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
  targets=(read-{mesh,meshb,node,ele,face,ovm,msh,vtk,vtu,stl,obj,off,ply} round_trip improve)
fi

"$root/scripts/install-deps.sh"
if ! command -v clang++ > /dev/null; then
  echo "libfuzzer: clang is missing; scripts/install-deps.sh --dev installs it" >&2
  exit 1
fi
mkdir -p "$build"
cmake -S "$root" -B "$build" -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" -DHFR_TESTS=ON -DHFR_FUZZERS=ON -DHFR_C_API=OFF > "$build/log" ||
  { cat "$build/log" >&2; exit 1; }
cmake --build "$build" --parallel "$("$root/scripts/jobs.sh")" --target hfr_fuzzers --target test_IO

programs=$build/unittests/LibFuzzer
seeds=$build/seeds
if [ ! -d "$seeds" ]; then
  "$programs/hfr_make_inputs" "$seeds.new"
  # The files of the readers' own tests; broken ones that are made by the thousand are libFuzzer's own work.
  HFR_KEEP_SAMPLES=$seeds.new "$build/unittests/IO/test_IO" --gtest_filter='-*BrokenFiles*:*CutAtEvery*' > "$build/log" ||
    { tail "$build/log" >&2; exit 1; }
  mv "$seeds.new" "$seeds"
fi

export OMP_WAIT_POLICY=passive
export LSAN_OPTIONS=suppressions=$root/unittests/LibFuzzer/leaks.txt:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1 ASAN_OPTIONS=detect_stack_use_after_return=0:allocator_may_return_null=0
seconds=$(awk -v minutes="$minutes" 'BEGIN { print int(60 * minutes) }')
status=0
for target in "${targets[@]}"; do
  program=$programs/fuzz_${target%%-*} arguments=()
  dictionary=$root/unittests/LibFuzzer/dictionaries/${target#read-}.dict
  corpus=$build/corpus/$target findings=$build/findings/$target
  mkdir -p "$corpus" "$findings" "$seeds/$target"
  [ "$target" = "${target#read-}" ] || arguments+=("--format=${target#read-}")
  [ ! -e "$dictionary" ] || arguments+=("-dict=$dictionary")
  kept=$root/unittests/LibFuzzer/kept/$target
  [ ! -d "$kept" ] || arguments+=("$kept")
  log=$build/$target.log
  code=0
  "$program" "$corpus" "$seeds/$target" -max_total_time="$seconds" -max_len=4096 -timeout=300 -rss_limit_mb=3000 \
    -malloc_limit_mb=1000 -print_final_stats=1 -artifact_prefix="$findings/" "${arguments[@]}" > "$log" 2>&1 || code=$?
  awk -v target="$target" -v code="$code" '
    /^stat::number_of_executed_units/ { runs = $2 }
    /cov: / { for (i = 1; i < NF; ++i) { if ($i == "cov:") cov = $(i + 1); if ($i == "corp:") corpus = $(i + 1) } }
    /^broken: |^==.*ERROR: |runtime error: / { if (what == "") what = $0 }
    END { printf "%s: %d runs, %d edges of the code, corpus %s%s\n", target, runs, cov, corpus,
          code == 0 ? ", no finding" : ": FINDING " what }' "$log"
  if [ "$code" -ne 0 ]; then
    echo "  see $log; the input: $(ls -t "$findings" | head -1)"
    status=1
  fi
done
exit "$status"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Ends `hfremesh improve` at random moments, from reading to writing: by kill -9, SIGTERM, SIGINT, SIGHUP, a file that
# may not grow (as on a full disk), and memory that runs out. After each run the output has to be the old file or a
# whole new one that `hfremesh check` takes, the exit code one of docs/exit-codes.md for that fault, and no temporary
# file may be left but after kill -9. Exit 1 at the first fault found, with its seed.
# Usage: scripts/faults.sh [TOOL [RUNS [SEED]]]     RUNS of each kind, 20 by default
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
tool=$(realpath "${1:-$root/build/release/apps/hfremesh/hfremesh}")
runs=${2:-20}
RANDOM=${3:-1}
work=$(mktemp -d)
# A signal may meet the child before it is the tool, while this trap is still its own.
trap '[ "$BASHPID" != "$$" ] || rm -rf "$work"' EXIT
export OMP_WAIT_POLICY=passive
cd "$work"
"$tool" generate cavity --n 24 24 24 -o in.vtu -q > /dev/null
"$tool" generate box --n 3 3 3 -o old.vtu -q > /dev/null
old=$(sha256sum < old.vtu)
begin=$(date +%s%N)
"$tool" in.vtu -o whole.vtu -q -j 2 > /dev/null
nanoseconds=$(($(date +%s%N) - begin))
size=$(stat -c %s whole.vtu)
n_old=0 n_new=0 tally=()

fail() {
  echo "faults: $1" >&2
  exit 1
}

# WHAT CODE CODES: looks at what a run that ended with CODE has left.
judge() {
  local what=$1 code=$2 codes=$3
  tally[$code]=$((${tally[$code]:-0} + 1))
  case " $codes " in *" $code "*) ;; *) fail "$what: exit code $code, not one of: $codes; $(tail -1 said.txt)" ;; esac
  [ -e out.vtu ] || fail "$what: the output is gone"
  if [ "$(sha256sum < out.vtu)" = "$old" ]; then
    n_old=$((n_old + 1))
    # 130 is what the shell makes of SIGINT, too, where it came before the run could be cancelled.
    case "$what $code" in
      SIGINT*' 130') ;;
      *' 0' | *' 3' | *' 4' | *' 130') fail "$what: exit code $code and the old file" ;;
    esac
  else
    n_new=$((n_new + 1))
    local checked=0
    "$tool" check out.vtu -q > /dev/null 2> said.txt || checked=$?
    case $checked in 0 | 4) ;; *) fail "$what: the new file is refused: $(tail -1 said.txt)" ;; esac
  fi
  if compgen -G '.*.tmp' > /dev/null; then
    [ "$code" = 137 ] || fail "$what: left $(compgen -G '.*.tmp')"
    rm -f .*.tmp
  fi
}

# SIGNAL CODES: sends it once, at a random moment of 1.2 times the run.
by_signal() {
  local signal=$1 codes=$2 code pid wait_ns
  cp old.vtu out.vtu
  wait_ns=$((nanoseconds * 12 / 10 * (RANDOM * 32768 + RANDOM) / (1 << 30)))
  # A shell without job control has SIGINT ignored by what it starts in the background.
  env --default-signal=INT "$tool" in.vtu -o out.vtu -q -j 2 > /dev/null 2> said.txt &
  pid=$!
  sleep "$((wait_ns / 1000000000)).$(printf '%09d' $((wait_ns % 1000000000)))"
  kill -s "$signal" "$pid" 2> /dev/null || true
  code=0
  wait "$pid" 2> /dev/null || code=$?
  judge "SIG$signal after $wait_ns ns" "$code" "$codes"
}

# Files may have this many blocks of 1,024 bytes; SIGXFSZ ends the process where it is not ignored.
by_file_size() {
  local blocks=$((size * (RANDOM * 32768 + RANDOM) / (1 << 30) / 1024)) code=0
  cp old.vtu out.vtu
  (ulimit -f "$blocks" && exec "$tool" in.vtu -o out.vtu -q -j 2) > /dev/null 2> said.txt || code=$?
  judge "files of $blocks KiB" "$code" "1"
}

# KiB of address space: from what the program itself takes to what it needs.
by_memory() {
  local kib=$((15000 + RANDOM * 5 / 2)) code=0
  cp old.vtu out.vtu
  (ulimit -v "$kib" && exec "$tool" in.vtu -o out.vtu -q -j 2) > /dev/null 2> said.txt || code=$?
  judge "$kib KiB of memory" "$code" "0 5 127"
}

# After 130 a signal came again, or before improve() could be cancelled: the shell sees it then.
for kind in "by_signal KILL '137 0 4'" "by_signal TERM '130 143 0 4'" "by_signal INT '130 0 4'" \
  "by_signal HUP '130 129 0 4'" by_file_size by_memory; do
  n_old=0 n_new=0 tally=()
  for ((i = 0; i < runs; ++i)); do eval "$kind"; done
  echo "${kind%% \'*}: $runs runs, the old file $n_old times, a new one $n_new times; exit codes$(
    for code in "${!tally[@]}"; do printf ' %s (%s)' "$code" "${tally[$code]}"; done
  )"
done

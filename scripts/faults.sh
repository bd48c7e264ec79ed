#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Ends runs of the tool and looks at what they leave:
#   - `improve` at random moments by kill -9, SIGTERM, SIGINT, SIGHUP, a file that may not grow, a full disk, and memory
#     that runs out. The disk is a small file system in memory; where nothing may be mounted a line says so;
#   - `improve` in each phase by name (reading, building, each stage, statistics, writing; by the times of a whole
#     run's report), by kill -9 and SIGTERM;
#   - `convert`, `move` and `report` at random moments by the four signals, a file that may not grow, and a full disk.
# After each run the output has to be the old file or a whole new one (a mesh that `hfremesh check` takes, a page with
# its last line), the exit code one of docs/exit-codes.md for that fault, and no temporary file may be left but after
# kill -9. Exit 1 at the first fault found.
# Usage: scripts/faults.sh [TOOL [RUNS [SEED]]]     RUNS of each kind, 20 by default
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
tool=$(realpath "${1:-$root/build/release/apps/hfremesh/hfremesh}")
runs=${2:-20}
RANDOM=${3:-1}
work=$(mktemp -d)
mounted=no
# A signal may meet the child before it is the tool, while this trap is still its own.
trap '[ "$BASHPID" != "$$" ] || { [ "$mounted" = no ] || umount "$work/full"; rm -rf "$work"; }' EXIT
export OMP_WAIT_POLICY=passive
cd "$work"
"$tool" generate cavity --n 24 24 24 -o in.vtu -q > /dev/null
"$tool" generate box --n 3 3 3 -o old.vtu -q > /dev/null
"$tool" in.vtu -o whole.vtu -q -j 2 > /dev/null
"$tool" report old.vtu old.vtu -o old.html -q > /dev/null
# A field that moves the vertices, for `move`: each to twice its place, by the coordinates of a text file.
"$tool" convert in.vtu in.vtk > /dev/null
awk '/^POINTS/ { n = $2; on = 1 } { print } on && NF == 3 && $1 ~ /^[-0-9]/ { at[++k] = $0 }
  END {
    print "POINT_DATA " n "\nFIELD FieldData 1\nu 3 " n " double"
    for (i = 1; i <= n; ++i) print at[i]
  }' \
  in.vtk > moving.vtk
n_old=0 n_new=0 tally=()
subcommand=() out='' nanoseconds=0 size=0

fail() {
  echo "faults: $1" >&2
  exit 1
}

# NAME: what runs from here on, what it writes, how long that takes and how large it is.
choose() {
  out=out.vtu
  case $1 in
    improve) subcommand=(improve in.vtu -o "$out" -q -j 2) ;;
    convert) subcommand=(convert in.vtu "$out" -q) ;;
    move) subcommand=(move moving.vtk --displacement u -o "$out" -q -j 2) ;;
    report) out=out.html subcommand=(report in.vtu whole.vtu -o "$out" -q) ;;
  esac
  old=$(sha256sum < "old.${out##*.}")
  local begin
  begin=$(date +%s%N)
  "$tool" "${subcommand[@]}" > /dev/null
  nanoseconds=$(($(date +%s%N) - begin))
  size=$(stat -c %s "$out")
}

put_old() { cp "old.${out##*.}" "$out"; }

# A whole file of its kind?
is_whole() {
  local checked=0
  case $1 in
    *.html) tail -c 100 "$1" | grep -q '</html>' ;;
    *) "$tool" check "$1" -q > /dev/null 2> said.txt || checked=$?; [ $checked = 0 ] || [ $checked = 4 ] ;;
  esac
}

# WHAT CODE CODES: looks at what a run that ended with CODE has left.
judge() {
  local what=$1 code=$2 codes=$3
  tally[$code]=$((${tally[$code]:-0} + 1))
  case " $codes " in *" $code "*) ;; *) fail "$what: exit code $code, not one of: $codes; $(tail -1 said.txt)" ;; esac
  [ -e "$out" ] || fail "$what: the output is gone"
  if [ "$(sha256sum < "$out")" = "$old" ]; then
    n_old=$((n_old + 1))
    # 130 is what the shell makes of SIGINT, too, where it came before the run could be cancelled.
    case "$what $code" in
      *SIGINT*' 130') ;;
      *' 0' | *' 3' | *' 4' | *' 130') fail "$what: exit code $code and the old file" ;;
    esac
  else
    n_new=$((n_new + 1))
    is_whole "$out" || fail "$what: the new file is refused: $(tail -1 said.txt)"
  fi
  if compgen -G "$(dirname "$out")/.*.tmp" > /dev/null; then
    [ "$code" = 137 ] || fail "$what: left $(compgen -G "$(dirname "$out")/.*.tmp")"
    rm -f "$(dirname "$out")"/.*.tmp
  fi
}

# SIGNAL CODES: sends it once, at a random moment of 1.2 times the run.
by_signal() {
  local signal=$1 codes=$2 code pid wait_ns
  put_old
  wait_ns=$(($(random_below $((nanoseconds / 1000 * 12 / 10))) * 1000))
  # A shell without job control has SIGINT ignored by what it starts in the background, and nohup SIGHUP.
  env --default-signal=INT,HUP "$tool" "${subcommand[@]}" > /dev/null 2> said.txt &
  pid=$!
  sleep "$((wait_ns / 1000000000)).$(printf '%09d' $((wait_ns % 1000000000)))"
  kill -s "$signal" "$pid" 2> /dev/null || true
  code=0
  wait "$pid" 2> /dev/null || code=$?
  judge "${subcommand[0]}: SIG$signal after $wait_ns ns" "$code" "$codes"
}

# PHASE BEGIN LENGTH SIGNAL CODES: sends it once to `improve`, BEGIN microseconds after the start and up to LENGTH
# later, or, while writing, as soon as there is a temporary file.
by_phase() {
  local phase=$1 begin=$2 length=$3 signal=$4 codes=$5 code=0 pid wait_us
  put_old
  "$tool" "${subcommand[@]}" > /dev/null 2> said.txt &
  pid=$!
  if [ "$phase" = write ]; then
    until compgen -G '.*.tmp' > /dev/null || ! kill -0 "$pid" 2> /dev/null; do sleep 0.002; done
  else
    wait_us=$((begin + $(random_below "$length")))
    sleep "$((wait_us / 1000000)).$(printf '%06d' $((wait_us % 1000000)))"
  fi
  kill -s "$signal" "$pid" 2> /dev/null || true
  wait "$pid" 2> /dev/null || code=$?
  judge "SIG$signal in $phase" "$code" "$codes"
}

# A line for each phase of a whole run: its name, and the microseconds at which it begins and that it takes; of a stage
# that comes again its longest time. What the report does not time is the start of the program.
phases() {
  local begin
  begin=$(date +%s%N)
  "$tool" "${subcommand[@]}" --json report.json > /dev/null
  python3 - report.json $((($(date +%s%N) - begin) / 1000)) << 'PHASES'
import json, sys
report, whole = json.load(open(sys.argv[1])), int(sys.argv[2])
seconds = report["seconds"]
at = max(0.0, whole * 1e-6 - sum(seconds.values()))
found = {}
def add(name, begin, length):
    if length > found.get(name, (0, -1))[1]:
        found[name] = (begin, length)
for name in ("read", "build"):
    add(name, at, seconds[name])
    at += seconds[name]
passes = report["passes"]
share = seconds["improve"] / max(1e-9, sum(p["seconds"]["total"] for p in passes))
stage, begin = None, at
for p in passes + [{"stage": None, "seconds": {"total": 0}}]:
    if p["stage"] != stage:
        if stage:
            add(stage, begin, at - begin)
        stage, begin = p["stage"], at
    at += share * p["seconds"]["total"]
for name in ("statistics", "write"):
    add(name, at, seconds[name])
    at += seconds[name]
for name, (begin, length) in found.items():
    print(name, int(1e6 * begin), int(1e6 * length))
PHASES
}

random_below() { echo $(($1 * (RANDOM * 32768 + RANDOM) / (1 << 30))); }

# Files may have this many blocks of 1,024 bytes; SIGXFSZ ends the process where it is not ignored.
by_file_size() {
  local blocks code=0
  blocks=$(($(random_below "$size") / 1024))
  put_old
  (ulimit -f "$blocks" && exec "$tool" "${subcommand[@]}") > /dev/null 2> said.txt || code=$?
  judge "${subcommand[0]}: files of $blocks KiB" "$code" "1"
}

# A file system that has room for the old file and a part of the new one.
by_full_disk() {
  local name=${out##*/} kib code=0 room
  room=$(stat -c %s "old.${name##*.}")
  kib=$(((room + 8192 + $(random_below "$size")) / 1024))
  mount -t tmpfs -o "size=${kib}k" hfremesh_faults full
  mounted=yes
  out=full/$name
  cp "old.${name##*.}" "$out"
  (exec "$tool" "${subcommand[@]/$name/$out}") > /dev/null 2> said.txt || code=$?
  judge "${subcommand[0]}: a disk of $kib KiB" "$code" "1"
  grep -q 'No space left' said.txt || fail "${subcommand[0]}: a full disk is not named: $(tail -1 said.txt)"
  umount full
  mounted=no
  out=$name
}

# KiB of address space: from what the program itself takes to what it needs.
by_memory() {
  local kib=$((15000 + RANDOM * 5 / 2)) code=0
  put_old
  (ulimit -v "$kib" && exec "$tool" "${subcommand[@]}") > /dev/null 2> said.txt || code=$?
  judge "${subcommand[0]}: $kib KiB of memory" "$code" "0 5 127"
}

# KIND ...: as often as was asked for.
repeat() {
  n_old=0 n_new=0 tally=()
  for ((i = 0; i < runs; ++i)); do "$@"; done
  echo "${subcommand[0]}, $*: $runs runs, the old file $n_old times, a new one $n_new times; exit codes$(
    for code in "${!tally[@]}"; do printf ' %s (%s)' "$code" "${tally[$code]}"; done
  )"
}

mkdir full
if mount -t tmpfs -o size=64k hfremesh_faults full 2> /dev/null; then
  umount full
  can_mount=yes
else
  can_mount=no
  echo "full disk: left out, for nothing may be mounted here"
fi

choose improve
# After 130 a signal came again, or before improve() could be cancelled: the shell sees it then.
repeat by_signal KILL '137 0 4'
repeat by_signal TERM '130 143 0 4'
repeat by_signal INT '130 0 4'
repeat by_signal HUP '130 129 0 4'
repeat by_file_size
[ "$can_mount" = no ] || repeat by_full_disk
repeat by_memory
phases > phases.txt
while read -r phase begin length <&4; do
  repeat by_phase "$phase" "$begin" "$length" KILL '137 0 4'
  repeat by_phase "$phase" "$begin" "$length" TERM '130 143 0 4'
done 4< phases.txt
for name in convert move report; do
  choose "$name"
  repeat by_signal KILL '137 0 3 4'
  repeat by_signal TERM '130 143 0 3 4'
  repeat by_signal INT '130 0 3 4'
  repeat by_signal HUP '130 129 0 3 4'
  repeat by_file_size
  [ "$can_mount" = no ] || repeat by_full_disk
done

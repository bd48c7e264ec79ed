#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the tool, checks that the device gives the bits of the processor, and measures both: all in one call.
# Usage: bench/device.sh [--device NAME] [--build FOLDER] [--mesh FILE]... [--size N]... [--repeat N]
#   --device NAME   as hfremesh improve takes it; default opencl
#   --build FOLDER  where to build; default build/device in the checkout
#   --mesh FILE     a mesh to check and measure; may be given more than once
#   --size N        a generated cube of 6*N*N*N cells as well; default 12 and 40 when nothing else is named
#   --repeat N      runs of each kind, of which the quickest counts; default 3
# Surface operators are left out where OpenMesh is missing. On a machine whose NVIDIA driver came without an ICD
# file, libnvidia-opencl.so.1 is named to the loader.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
device=opencl build=$root/build/device repeat=3 meshes=() sizes=()
while [ $# -gt 0 ]; do
  case $1 in
    --device) device=$2 ;;
    --build) build=$2 ;;
    --mesh) meshes+=("$2") ;;
    --size) sizes+=("$2") ;;
    --repeat) repeat=$2 ;;
    *) sed -n '3,12s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 1 ;;
  esac
  shift 2
done
[ ${#meshes[@]} -gt 0 ] || [ ${#sizes[@]} -gt 0 ] || sizes=(12 40)

surface=ON
[ -e /usr/include/OpenMesh ] || [ -e /usr/local/include/OpenMesh ] || surface=OFF
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DHFR_OPENCL=ON -DHFR_SURFACE=$surface -DHFR_TESTS=OFF \
  > "$build.log" 2>&1 || { cat "$build.log" >&2; exit 1; }
cmake --build "$build" --target hfremesh_tool --parallel "$("$root/scripts/jobs.sh")" >> "$build.log" 2>&1 ||
  { tail -n 40 "$build.log" >&2; exit 1; }
tool=$build/apps/hfremesh/hfremesh

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# The driver of an NVIDIA GPU without the file that tells the loader of it.
if ! "$tool" devices | grep -qi nvidia && ldconfig -p | grep -q libnvidia-opencl.so.1; then
  mkdir "$work/vendors"
  echo libnvidia-opencl.so.1 > "$work/vendors/nvidia.icd"
  cat /etc/OpenCL/vendors/*.icd > "$work/vendors/others.icd" 2> /dev/null || true
  export OCL_ICD_VENDORS=$work/vendors OPENCL_VENDOR_PATH=$work/vendors
fi
"$tool" devices -v

for n in "${sizes[@]}"; do
  "$tool" generate box --n "$n" "$n" "$n" --jitter 0.25 -o "$work/box$n.meshb" -q 2> /dev/null ||
    "$tool" generate box --n "$n" "$n" "$n" --jitter 0.25 -o "$work/box$n.mesh" -q
  meshes+=("$(ls "$work/box$n".mesh*)")
done

# run LABEL MESH OUTPUT OPTION...: the quickest of some runs; its report is $work/LABEL.json.
run() {
  local label=$1 mesh=$2 output=$3 best="" seconds code
  shift 3
  for _ in $(seq "$repeat"); do
    code=0
    "$tool" "$mesh" -o "$output" -q --json "$work/try.json" "$@" || code=$?
    [ $code -le 4 ] || exit $code
    seconds=$(python3 -c 'import json,sys; r=json.load(open(sys.argv[1])); print(r["seconds"]["improve"] - r["device"]["seconds_open"])' \
      "$work/try.json")
    if [ -z "$best" ] || python3 -c 'import sys; sys.exit(float(sys.argv[1]) >= float(sys.argv[2]))' "$seconds" "$best"; then
      best=$seconds
      mv "$work/try.json" "$work/$label.json"
    fi
  done
}

faults=0
for mesh in "${meshes[@]}"; do
  echo
  echo "== $(basename "$mesh")"
  extension=${mesh##*.}
  [ "$extension" != ele ] || extension=mesh
  run cpu "$mesh" "$work/cpu.$extension"
  run device "$mesh" "$work/there.$extension" --device "$device"
  run hybrid "$mesh" "$work/hybrid.$extension" --device "$device" --hybrid
  repeat_before=$repeat repeat=1
  run profile "$mesh" "$work/profile.$extension" --device "$device" --profile
  repeat=$repeat_before
  for kind in there hybrid profile; do
    if cmp -s "$work/cpu.$extension" "$work/$kind.$extension"; then
      echo "$kind: the bytes of the processor"
    else
      echo "$kind: DIFFERS from the processor"
      faults=$((faults + 1))
    fi
  done
  python3 - "$work" << 'PYTHON'
import json, sys
load = lambda label: json.load(open(f"{sys.argv[1]}/{label}.json"))
runs = {label: load(label) for label in ("cpu", "device", "hybrid")}
print(f"{'run':8} {'improve':>9} {'open':>8} {'bulk':>9} {'bulk there':>11}   seconds; improve without open")
for label, run in runs.items():
    bulk = [p for p in run["passes"] if p["stage"] == "bulk"]
    total = lambda passes: sum(p["seconds"]["total"] for p in passes)
    opened = run["device"]["seconds_open"]
    print(f"{label:8} {run['seconds']['improve'] - opened:9.3f} {opened:8.3f} {total(bulk):9.3f} "
          f"{total([p for p in bulk if p['on_device']]):11.3f}")
ratio = lambda label: ((runs[label]["seconds"]["improve"] - runs[label]["device"]["seconds_open"])
                       / runs["cpu"]["seconds"]["improve"])
print(f"device / processor {ratio('device'):.2f}, hybrid / processor {ratio('hybrid'):.2f}")
print("kernel                   launches   seconds")
for k in load("profile")["device"]["kernels"][:16]:
    print(f"{k['kernel']:24} {k['launches']:8} {k['seconds']:9.4f}")
PYTHON
done
[ $faults -eq 0 ] || { echo "$faults outputs differ" >&2; exit 1; }

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the tool, checks that the device gives the bits of the processor, and measures both: all in one call,
# without a network where the packages are there. Prints Markdown; exit 1 where an output differs.
# Usage: bench/device.sh [--device NAME] [--build FOLDER | --tool FILE] [--mesh FILE]... [--size N]...
#                        [--cavity N] [--repeat N] [--with OPTION]... [--out FILE]
#   --device NAME   as the tool's own; default opencl
#   --build FOLDER  where to build; default build/device in the checkout
#   --tool FILE     measure this one, and build nothing
#   --mesh FILE     a mesh to check and measure; may be given more than once
#   --size N        a generated box of 6*N*N*N cells; may be given more than once
#   --cavity N      the paper's cavity with about N thousand cells
#   --repeat N      runs of each kind, of which the quickest counts; default 3
#   --with OPTION   an option of the tool for every run, such as --bulk-nodes; may be given more than once
#   --out FILE      the tables go there as well
# With no mesh named: on a GPU the cavity of 607,200 cells and boxes of 2 and 10 million (--cavity 607
# --size 70 --size 119); on a CPU a tenth of that (--cavity 63 --size 32).
# Surface operators are left out where OpenMesh is missing. Where the driver of an NVIDIA GPU came without an
# ICD file, the loader is given one that names libnvidia-opencl.so.1, in a folder of this script.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
device=opencl build=$root/build/device tool='' repeat=3 out=/dev/null cavity='' meshes=() sizes=() options=()
while [ $# -gt 0 ]; do
  case $1 in
    --device) device=$2 ;;
    --build) build=$2 ;;
    --tool) tool=$2 ;;
    --mesh) meshes+=("$2") ;;
    --size) sizes+=("$2") ;;
    --cavity) cavity=$2 ;;
    --repeat) repeat=$2 ;;
    --with) options+=("$2") ;;
    --out) out=$2 ;;
    *) sed -n '3,19s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 1 ;;
  esac
  shift 2
done

build_tool() {
  local surface=ON
  [ -e /usr/include/OpenMesh ] || [ -e /usr/local/include/OpenMesh ] || surface=OFF
  mkdir -p "$build"
  cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DHFR_OPENCL=ON -DHFR_SURFACE=$surface \
    -DHFR_TESTS=OFF > "$build/build.log" 2>&1 || { cat "$build/build.log" >&2; exit 1; }
  cmake --build "$build" --target hfremesh_tool --parallel "$("$root/scripts/jobs.sh")" \
    >> "$build/build.log" 2>&1 || { tail -n 40 "$build/build.log" >&2; exit 1; }
  tool=$build/apps/hfremesh/hfremesh
}
[ -n "$tool" ] || build_tool

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# The CUDA installation may bring the only loader, in a folder that is not searched.
if [ -z "${HFR_OPENCL_LIBRARY:-}" ] && "$tool" devices | grep "no OpenCL loader" > /dev/null; then
  for loader in /usr/local/cuda/lib64/libOpenCL.so.1 /usr/local/cuda/targets/*/lib/libOpenCL.so.1; do
    if [ -e "$loader" ]; then export HFR_OPENCL_LIBRARY=$loader; fi
  done
fi
# The driver of an NVIDIA GPU without the file that tells the loader of it. Loaders differ in the variable
# that they read.
has_driver() { ldconfig -p | grep libnvidia-opencl.so.1 > /dev/null; }
if ! "$tool" devices | grep -i nvidia > /dev/null && has_driver; then
  mkdir "$work/vendors"
  for icd in /etc/OpenCL/vendors/*.icd; do
    if [ -e "$icd" ]; then cp "$icd" "$work/vendors/"; fi
  done
  echo libnvidia-opencl.so.1 > "$work/vendors/nvidia.icd"
  export OCL_ICD_VENDORS=$work/vendors/ OPENCL_VENDOR_PATH=$work/vendors
  export OCL_ICD_FILENAMES=libnvidia-opencl.so.1
fi
"$tool" devices -v

if [ -z "$cavity" ] && [ ${#meshes[@]} -eq 0 ] && [ ${#sizes[@]} -eq 0 ]; then
  cavity=63 sizes=(32)
  if command -v nvidia-smi > /dev/null && nvidia-smi > /dev/null 2>&1; then cavity=607 sizes=(70 119); fi
fi
if [ -n "$cavity" ]; then
  # 44 x 46 x 50 cubes are 607,200 cells.
  read -r nx ny nz <<< "$(python3 -c 'import sys; s = (float(sys.argv[1]) / 607.2) ** (1 / 3)
print(*(round(n * s) for n in (44, 46, 50)))' "$cavity")"
  "$tool" generate cavity --n "$nx" "$ny" "$nz" --jitter 0.201 --sigma 0.08 --amplitude 0.27877 --seed 2013 \
    -o "$work/cavity$cavity.meshb" -q
  meshes+=("$work/cavity$cavity.meshb")
fi
for n in "${sizes[@]}"; do
  "$tool" generate box --n "$n" "$n" "$n" --jitter 0.25 -o "$work/box$n.meshb" -q
  meshes+=("$work/box$n.meshb")
done

# run LABEL MESH OUTPUT N OPTION...: the quickest of N runs; its report is $work/LABEL.json.
run() {
  local label=$1 mesh=$2 output=$3 n=$4 best='' time code
  shift 4
  for _ in $(seq "$n"); do
    code=0
    "$tool" "$mesh" -o "$output" -q --json "$work/try.json" "${options[@]}" "$@" || code=$?
    [ $code -le 4 ] || exit $code
    time=$("$root/bench/device_table.py" --microseconds "$work/try.json")
    if [ -z "$best" ] || [ "$time" -lt "$best" ]; then
      best=$time
      mv "$work/try.json" "$work/$label.json"
    fi
  done
}

faults=0
measure() {
  local mesh=$1 extension=${1##*.} kind
  echo
  echo "## $(basename "$mesh")"
  echo
  [ "$extension" != ele ] && [ "$extension" != node ] || extension=mesh
  run cpu "$mesh" "$work/cpu.$extension" "$repeat"
  run device "$mesh" "$work/device.$extension" "$repeat" --device "$device"
  run hybrid "$mesh" "$work/hybrid.$extension" "$repeat" --device "$device" --hybrid
  run profile "$mesh" "$work/profile.$extension" 1 --device "$device" --profile
  for kind in device hybrid profile; do
    if cmp -s "$work/cpu.$extension" "$work/$kind.$extension"; then
      echo "- $kind: the bytes of the processor"
    else
      echo "- $kind: DIFFERS from the processor"
      faults=$((faults + 1))
    fi
  done
  echo
  "$root/bench/device_table.py" "$work"
}
for mesh in "${meshes[@]}"; do measure "$mesh" > "$work/table"; tee -a "$out" < "$work/table"; done
[ $faults -eq 0 ] || { echo "$faults outputs differ" >&2; exit 1; }

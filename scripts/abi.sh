#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Compares the binary interfaces of two builds of the shared libraries by abidiff, public headers alone.
# Usage: scripts/abi.sh OLD NEW     prefixes that each was installed to (cmake --install BUILD --prefix PREFIX)
# Exit code 0: whoever was linked with OLD runs with NEW. Without debugging information (-g) only the names of functions
# and variables are compared.
set -euo pipefail
if [ $# -ne 2 ] || ! command -v abidiff > /dev/null; then
  sed -n '3,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
  echo "It needs abidiff (Debian: abigail-tools)." >&2
  exit 1
fi
differs=0
for library in libhfremesh.so libhfremesh_c.so; do
  old=$(find "$1" -name "$library" | head -n 1)
  new=$(find "$2" -name "$library" | head -n 1)
  if [ -z "$old" ] || [ -z "$new" ]; then
    echo "abi: $library is not in both" >&2
    exit 1
  fi
  echo "$library"
  # Bit 4 of the exit code: the interface changed; bit 8: it broke.
  abidiff --headers-dir1 "$1/include" --headers-dir2 "$2/include" --no-added-syms "$old" "$new" || {
    code=$?
    [ $((code & 3)) -eq 0 ] || exit "$code"
    differs=1
  }
done
exit "$differs"

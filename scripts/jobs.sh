#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints how many compilers may run at once: one for each core, but one for each 1.2 GiB of free memory at most,
# because the largest translation units (OpenMesh, Eigen) need that much.
set -euo pipefail
jobs=$(nproc 2> /dev/null || echo 1)
if [ -r /proc/meminfo ]; then
  by_memory=$(awk '/^MemAvailable:/ {print int($2 / 1258291)}' /proc/meminfo)
  if [ -n "$by_memory" ] && [ "$by_memory" -lt "$jobs" ]; then jobs=$by_memory; fi
fi
[ "$jobs" -ge 1 ] || jobs=1
echo "$jobs"

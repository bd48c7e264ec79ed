#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that clang-format 14 would change nothing in our sources.
# Usage: scripts/check-format.sh [--fix]     --fix changes them
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
mode=(--dry-run -Werror)
[ "${1:-}" != --fix ] || mode=(-i)

format=clang-format-14
if ! command -v "$format" > /dev/null; then
  echo "check-format: $format is missing; scripts/install-deps.sh --dev installs it" >&2
  exit 1
fi
mapfile -t files < <(find src kernels apps bindings unittests examples bench -type f \
  \( -name '*.cc' -o -name '*.hh' -o -name '*.h' -o -name '*.cl' \) | LC_ALL=C sort)
printf '%s\0' "${files[@]}" | xargs -0 -n 16 -P "$(nproc)" "$format" "${mode[@]}"
echo "check-format: ${#files[@]} files"

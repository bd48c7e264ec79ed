#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that the layers from Parallel to Scheduler, but for IO, compile with clang and its own standard library.
# IO reads numbers with std::from_chars, which libc++ has for doubles from version 20 on only.
# Syntax alone: nothing is linked or run.
# Usage: scripts/libcxx.sh
#   CXX=COMPILER        default clang++
#   HFR_LIBCXX=FLAGS    where libc++ is; default -stdlib=libc++
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
[ -n "${HFR_LIBCXX:-}" ] || "$root/scripts/install-deps.sh" --libcxx
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# The build tree's <hfremesh/...>, without CMake.
mkdir -p "$work/config"
sed -E 's/@[A-Z_]+@/0/; /^#cmakedefine/d' "$root/src/HalfFace/Config.hh.in" > "$work/config/Config.hh"
for header in "$root"/src/*/*.hh "$root"/kernels/*.h "$work/config/Config.hh"; do
  folder=$work/include/hfremesh/$(basename "$(dirname "$header")")
  folder=${folder/%config/HalfFace}
  mkdir -p "$folder"
  printf '#include "%s"\n' "$header" > "$folder/$(basename "$header")"
done

cd "$root"
read -ra flags <<< "${HFR_LIBCXX:--stdlib=libc++}"
sources=()
for file in src/Parallel/*.cc src/HalfFace/*.cc src/Quality/*.cc src/Transfer/*.cc src/Operators/*.cc src/Scheduler/*.cc; do
  case $file in */BackendOpenMp.cc | */BackendTbb.cc) continue ;; esac
  sources+=("$file")
done
# Templates that no source of these layers makes: the headers by themselves.
sources+=(src/Scheduler/Round.hh src/Scheduler/RunUntilQuiet.hh src/Scheduler/SmoothPass.hh)
printf '%s\n' "${sources[@]}" | xargs -P "$(scripts/jobs.sh)" -I{} \
  "${CXX:-clang++}" "${flags[@]}" -std=c++20 -fsyntax-only -Wall -Wextra -Werror -Wno-pragma-once-outside-header \
  -ffp-contract=off -I src -I . -I "$work/include" -x c++ {}
echo "libcxx: ${#sources[@]} files compile"

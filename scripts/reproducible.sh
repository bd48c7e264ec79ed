#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Debian packages (the shared libraries and the tool in them) and the static library twice, in two folders,
# at two times of day and with other languages, and compares the bytes. Exit 1 where they differ.
# Usage: scripts/reproducible.sh
#   HFR_BUILD=FOLDER   where to build; default build/reproducible in the checkout. FOLDER/first and FOLDER/second/deeper
#                      are the two, each with its own copy of the files that git knows
# No cached objects are used: they would be those of the other build.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${HFR_BUILD:-$root/build/reproducible}
"$root/scripts/install-deps.sh" --tool
SOURCE_DATE_EPOCH=$(git -C "$root" log -1 --format=%ct)
export SOURCE_DATE_EPOCH CCACHE_DISABLE=1 HFR_DEB_CHECK=OFF
unset HFR_BUILD  # that of this script, not of deb.sh
rm -rf "$build"
mkdir -p "$build"

# Both copies first: the sources may be edited meanwhile.
for folder in "$build/first" "$build/second/deeper"; do
  mkdir -p "$folder/hfremesh"
  git -C "$root" ls-files -z | tar -C "$root" --null --files-from=- -cf - | tar -C "$folder/hfremesh" -xf -
done

build_in() {
  local folder=$1
  (
    cd "$folder/hfremesh"
    scripts/deb.sh
    # The objects are those of the shared library; archive and link are what is new.
    cmake -B build/deb -DBUILD_SHARED_LIBS=OFF
    cmake --build build/deb --target hfremesh_tool
  ) > "$folder/build.log" 2>&1 || { tail -20 "$folder/build.log" >&2; exit 1; }
}
TZ=UTC+11 LC_ALL=C.UTF-8 build_in "$build/first"
TZ=UTC-9 LC_ALL=C build_in "$build/second/deeper"

status=0
compare() {
  local one=$build/first/hfremesh/build/deb/$1 other=$build/second/deeper/hfremesh/build/deb/$1
  if cmp -s "$one" "$other"; then
    echo "same: $1 $(sha256sum < "$one" | cut -c1-16)"
  else
    echo "other bytes: $1"
    status=1
  fi
}
for package in "$build"/first/hfremesh/build/deb/packages/*.deb; do compare "packages/${package##*/}"; done
compare src/libhfremesh.a
# The tool in the build tree knows where it was built, the installed one does not: that is in the package.
exit "$status"

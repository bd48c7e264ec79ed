#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the recipe of Conan (packaging/conan): builds a package, static and shared, and with each the recipe's test,
# a program that repairs a mesh. What the recipe requires is taken from Debian by packaging/conan/system.
# Usage: scripts/conan.sh
#   HFR_BUILD=FOLDER  where to work; default build/conan in the checkout. Conan's own folder is in it, too
# It needs Conan 2 from the Python Package Index; once that is in FOLDER/tools it needs no network.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=${HFR_BUILD:-$root/build/conan}
"$root/scripts/install-deps.sh" --tool
mkdir -p "$work"
if [ ! -x "$work/tools/bin/conan" ]; then
  "${PYTHON:-python3}" -m venv "$work/tools"
  "$work/tools/bin/pip" install --quiet 'conan>=2.4,<3'
fi
export CONAN_HOME=$work/home
conan=$work/tools/bin/conan
"$conan" profile detect --exist-ok > "$work/profile.log" 2>&1
# Builds of test_package go beside it: a copy, and the checkout stays as it is.
rm -rf "$work/packaging" "$work/checkout"
mkdir "$work/checkout"
git -C "$root" ls-files -z CMakeLists.txt LICENSE cmake kernels src packaging/conan |
  tar -C "$root" --null --files-from=- -cf - | tar -C "$work/checkout" -xf -
cd "$work/checkout"

settings=(-s compiler.cppstd=20 -c "tools.build:jobs=$("$root/scripts/jobs.sh")" --no-remote)
while read -r name package; do
  version=$(dpkg-query -W -f='${Version}' "$package" | sed -E 's/^[0-9]+://; s/[^0-9.].*//')
  "$conan" create packaging/conan/system "--name=$name" "--version=$version" "${settings[@]}" > "$work/$name.log" 2>&1 ||
    { tail -20 "$work/$name.log" >&2; exit 1; }
done << 'PACKAGES'
fmt libfmt-dev
tinyxml2 libtinyxml2-dev
zlib zlib1g-dev
eigen libeigen3-dev
openmesh libopenmesh-dev
PACKAGES
for shared in False True; do
  log=$work/shared-$shared.log
  "$conan" create packaging/conan -o "hfremesh/*:shared=$shared" "${settings[@]}" > "$log" 2>&1 ||
    { tail -40 "$log" >&2; exit 1; }
  grep -E '^hfremesh [0-9.]+: ' "$log"
done
echo "conan: the recipe builds a static and a shared package, and both are used"

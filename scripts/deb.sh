#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Debian packages (libhfremesh0.1, libhfremesh-dev, hfremesh), installs them in a clean root of Debian 12,
# and uses them there: repairs a mesh, reads the man page's file, runs a program that was compiled with the dev package.
# Usage: scripts/deb.sh [source]
#   source             makes the Debian source package of packaging/debian instead, builds it with dpkg-buildpackage in
#                      a copy of the files that git knows, and has lintian look at all that came out; in FOLDER/source
#   HFR_BUILD=FOLDER   where to build; default build/deb in the checkout. The packages are in FOLDER/packages
#   HFR_DEB_CHECK=OFF  builds the packages, and installs them nowhere
# What it takes is installed, but for the clean root: that needs mmdebstrap, the rights of root, Debian 12 and a mirror that
# apt knows, and is left out with a line where one of the first three is missing. lintian looks at the packages where it is installed.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${HFR_BUILD:-$root/build/deb}
"$root/scripts/install-deps.sh" --tool --deb
# The same bytes wherever and whenever it is built: no folder and no time of the build in them.
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
  SOURCE_DATE_EPOCH=$(git -C "$root" log -1 --format=%ct 2> /dev/null || stat -c %Y "$root/CHANGELOG.md")
fi
export SOURCE_DATE_EPOCH

# The source package and the packages built of it.
from_source() {
  "$root/scripts/install-deps.sh" --packaging
  local version work tree
  version=$(sed -nE 's/^project\(hfremesh VERSION ([0-9.]+).*/\1/p' "$root/CMakeLists.txt")
  work=$build/source
  tree=$work/hfremesh-$version
  rm -rf "$work"
  mkdir -p "$tree"
  git -C "$root" ls-files -z | tar -C "$root" --null --files-from=- -cf - | tar -C "$tree" -xf -
  tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -cf - \
    "hfremesh-$version" | gzip -n > "$work/hfremesh_$version.orig.tar.gz"
  cp -r "$tree/packaging/debian" "$tree/debian"
  DEB_BUILD_OPTIONS=parallel=$("$root/scripts/jobs.sh")
  export DEB_BUILD_OPTIONS
  (cd "$tree" && dpkg-buildpackage -us -uc) > "$work/build.log" 2>&1 || { tail -40 "$work/build.log" >&2; exit 1; }
  ls "$work"/*.dsc "$work"/*.deb
  lintian --fail-on error "$work"/*.changes
  echo "deb: the source package builds, and lintian has no error"
}
case ${1:-} in
  source) from_source; exit 0 ;;
  '') ;;
  *) echo "deb: $1 is unknown" >&2; exit 1 ;;
esac

cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DBUILD_SHARED_LIBS=ON \
  -DCMAKE_SKIP_INSTALL_RPATH=ON -DCMAKE_BUILD_RPATH_USE_ORIGIN=ON -DHFR_TESTS=OFF -DHFR_BENCH=OFF \
  -DCMAKE_CXX_FLAGS="'-ffile-prefix-map=$build=.' '-ffile-prefix-map=$root=.'"
cmake --build "$build" --parallel "$("$root/scripts/jobs.sh")"
rm -rf "$build/packages"
(cd "$build" && cpack -G DEB -B packages > cpack.log) || { cat "$build/cpack.log" >&2; exit 1; }
rm -rf "$build/packages/_CPack_Packages"
for package in "$build"/packages/*.deb; do
  echo "${package##*/}: $(dpkg-deb -f "$package" Depends)"
done
if command -v lintian > /dev/null; then
  # A package made without a source package has no Debian changelog; that is the one error passed over.
  lintian --fail-on error --suppress-tags no-changelog,debian-changelog-file-missing "$build"/packages/*.deb
fi
case ${HFR_DEB_CHECK:-ON} in 0 | OFF | off | false) exit 0 ;; esac

suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
if [ "$(id -u)" -ne 0 ] || ! command -v mmdebstrap > /dev/null || [ "$suite" != bookworm ]; then
  echo "deb: the packages are made; they are not tried in a clean root, which takes root, mmdebstrap and Debian 12"
  exit 0
fi
clean=$build/clean-root
rm -rf "$clean"
depends=$(for package in "$build"/packages/*.deb; do dpkg-deb -f "$package" Depends; done | tr ',' '\n' |
  sed 's/(.*//; s/|.*//; s/ //g' | grep -v hfremesh | sort -u | paste -sd,)
mmdebstrap --quiet --variant=minbase --include="$depends" "$suite" "$clean"
mkdir -p "$clean/packages"
cp "$build"/packages/*.deb "$clean/packages/"
chroot "$clean" sh -c 'dpkg -i /packages/*.deb'
chroot "$clean" sh -c 'cd /tmp && hfremesh generate cavity -o bad.mesh && hfremesh bad.mesh -o good.mesh &&
  hfremesh check good.mesh && hfremesh bad.mesh -o good.vtu --png both.png -q && test -s both.png'
chroot "$clean" test -s /usr/share/man/man1/hfremesh.1.gz -o -s /usr/share/man/man1/hfremesh.1 || {
  # minbase roots may leave documentation out
  dpkg-deb -c "$build"/packages/hfremesh_*.deb | grep -q man1/hfremesh.1
}
# The README's program, compiled with what the dev package put there.
export PKG_CONFIG_SYSROOT_DIR=$clean
PKG_CONFIG_LIBDIR=$(dirname "$(find "$clean/usr/lib" -name hfremesh.pc)")
export PKG_CONFIG_LIBDIR
# shellcheck disable=SC2046
g++ -std=c++20 "$root/examples/readme_example.cc" $(pkg-config --cflags --libs hfremesh) \
  -Wl,--allow-shlib-undefined -o "$clean/tmp/example"
chroot "$clean" /tmp/example
chroot "$clean" sh -c 'dpkg -r hfremesh libhfremesh-dev libhfremesh0.1 > /dev/null && ! command -v hfremesh'
rm -rf "$clean"
echo "deb: installed, used and removed in a clean root"

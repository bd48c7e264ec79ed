#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Debian packages (libhfremesh0.1, libhfremesh-dev, hfremesh), installs them in a clean root of Debian 12,
# and uses them there: repairs a mesh, reads the man page's file, runs a program that was compiled with the dev package.
# Usage: scripts/deb.sh
#   HFR_BUILD=FOLDER   where to build; default build/deb in the checkout. The packages are in FOLDER/packages
#   HFR_DEB_CHECK=OFF  builds the packages, and installs them nowhere
# It needs dpkg-dev and file; for the clean root mmdebstrap, the rights of root, and a mirror that apt knows. lintian
# looks at the packages where it is installed.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${HFR_BUILD:-$root/build/deb}
"$root/scripts/install-deps.sh" --tool
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DBUILD_SHARED_LIBS=ON \
  -DCMAKE_SKIP_INSTALL_RPATH=ON -DHFR_TESTS=OFF -DHFR_BENCH=OFF
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

clean=$build/clean-root
rm -rf "$clean"
depends=$(for package in "$build"/packages/*.deb; do dpkg-deb -f "$package" Depends; done | tr ',' '\n' |
  sed 's/(.*//; s/|.*//; s/ //g' | grep -v hfremesh | sort -u | paste -sd,)
mmdebstrap --quiet --variant=minbase --include="$depends" bookworm "$clean"
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

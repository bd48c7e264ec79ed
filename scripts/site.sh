#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the site: the pages of docs/, and the reference of C++, C and Python, with a search box. Warnings are errors.
# Usage: scripts/site.sh
#   HFR_BUILD=FOLDER  where to work; default build/site in the checkout. The site is FOLDER/html/index.html
#   HFR_WHEEL=FILE    a wheel of scripts/python.sh, for a complete reference of Python. Without, it has what is written
#                     in Python: not the classes of the compiled module
# It needs doxygen (Debian: doxygen), and from the Python Package Index what docs/site/requirements.txt names. Once
# these are in FOLDER/tools it needs no network.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=${HFR_BUILD:-$root/build/site}
if ! command -v doxygen > /dev/null; then
  echo "site: doxygen is missing (Debian: apt-get install doxygen)" >&2
  exit 1
fi
mkdir -p "$work"
if ! cmp -s "$root/docs/site/requirements.txt" "$work/tools/installed"; then
  "${PYTHON:-python3}" -m venv "$work/tools"
  "$work/tools/bin/pip" install --quiet -r "$root/docs/site/requirements.txt"
  cp "$root/docs/site/requirements.txt" "$work/tools/installed"
fi
if [ -n "${HFR_WHEEL:-}" ]; then "$work/tools/bin/pip" install --quiet "$HFR_WHEEL"; fi

export PYTHONDONTWRITEBYTECODE=1
python=$work/tools/bin/python
"$python" "$root/docs/site/stage.py" "$root" "$work/source"
rm -rf "$work/doxygen" "$work/html"
mkdir -p "$work/doxygen"
cd "$root"
{
  cat docs/site/Doxyfile
  echo "INPUT = $("$python" docs/site/stage.py "$root" "$work/source" --headers) bindings/c/hfremesh.h"
  echo "OUTPUT_DIRECTORY = \"$work/doxygen\""
} | doxygen - > "$work/doxygen.log" 2>&1
# Two lines of Doxygen 1.9 about specialisations in std, which it cannot place.
if grep -E 'warning|error' "$work/doxygen.log" | grep -Ev 'std::hash<|std::ranges::enable_borrowed_range'; then
  echo "site: doxygen warns" >&2
  exit 1
fi
HFR_ROOT=$root HFR_DOXYGEN_XML=$work/doxygen/xml \
HFR_VERSION=$(sed -n 's/^project(hfremesh VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt) \
  "$work/tools/bin/sphinx-build" -q -W --keep-going -j 2 -c docs/site -d "$work/doctrees" "$work/source" "$work/html"
echo "The site: $work/html/index.html"

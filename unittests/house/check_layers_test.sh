#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# check-layers.sh accepts a small clean tree and names each fault that is then put into it.
set -euo pipefail
check=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{kernels,src/{Parallel,HalfFace,Quality,IO},apps/hfremesh,bindings/c}

clean() {
  printf 'set(HEADERS base.h)\n' > "$tree/kernels/CMakeLists.txt"
  : > "$tree/kernels/base.h"
  rm -f "$tree/kernels/new.h" "$tree/bindings/c/Mesh.cc" "$tree"/src/*/New.{cc,hh} "$tree/src/IO/Inner.hh"
  printf 'hfr_layer(Parallel HEADERS For.hh)\n' > "$tree/src/Parallel/CMakeLists.txt"
  printf 'hfr_layer(HalfFace SOURCES Mesh.cc HEADERS Mesh.hh)\n' > "$tree/src/HalfFace/CMakeLists.txt"
  printf 'hfr_layer(IO SOURCES Read.cc HEADERS Read.hh PRIVATE_HEADERS\n Inner.hh)\n' > "$tree/src/IO/CMakeLists.txt"
  printf '#include "hfremesh/HalfFace/Mesh.hh"\n' > "$tree/src/IO/Read.hh"
  : > "$tree/src/IO/Inner.hh"
  : > "$tree/src/HalfFace/Mesh.hh"
  printf '#include "Parallel/For.hh"\n// prints nothing: std::cout << 1; exit(1)\n' > "$tree/src/HalfFace/Mesh.cc"
  printf '#include "HalfFace/Mesh.hh"\nint exit_code(int); auto s = "std::cerr, abort()";\n' > "$tree/src/IO/Read.cc"
  printf '#pragma omp parallel for\n' > "$tree/src/Parallel/For.hh"
  printf '#include <hfremesh/IO/Read.hh>\n#include <iostream>\nint main() { std::cout << 1; }\n' > "$tree/apps/hfremesh/main.cc"
}

# expect_fault TEXT: the check fails, and says TEXT.
failed=0
expect_fault() {
  local said
  if said=$("$check" "$tree" 2>&1) || ! grep -qF -- "$1" <<< "$said"; then
    printf 'expected "%s"; check-layers said:\n%s\n' "$1" "$said"
    failed=1
  fi
  clean
}

clean
"$check" "$tree"
echo '#include "IO/Read.hh"' >> "$tree/src/HalfFace/Mesh.cc"
expect_fault 'src/HalfFace/Mesh.cc:3: HalfFace stands below'
echo '#include <Quality/Metrics.hh>' >> "$tree/kernels/base.h"
expect_fault 'kernels/base.h:1: kernels stand below'
echo '  #pragma omp atomic' >> "$tree/src/IO/Read.cc"
expect_fault 'src/IO/Read.cc:3: only src/Parallel knows the thread library'
echo '#include <omp.h>' >> "$tree/apps/hfremesh/main.cc"
expect_fault 'apps/hfremesh/main.cc:4: only src/Parallel knows the thread library'
echo '#include <hfremesh/IO/Inner.hh>' > "$tree/bindings/c/Mesh.cc"
expect_fault 'bindings/c/Mesh.cc:1: IO/Inner.hh is not a public header'
echo 'void f() { std::cerr << "no"; }' > "$tree/bindings/c/Mesh.cc"
expect_fault 'bindings/c/Mesh.cc:1: bindings/ neither prints'
echo 'void f() { std::cerr << "no"; }' >> "$tree/src/IO/Read.cc"
expect_fault 'src/IO/Read.cc:3: src/ neither prints'
echo 'void f() { fprintf(stderr, "no"); }' >> "$tree/src/IO/Read.cc"
expect_fault 'src/IO/Read.cc:3: src/ neither prints'
echo 'void f() { std::exit(1); }' >> "$tree/src/IO/Read.cc"
expect_fault 'src/IO/Read.cc:3: src/ neither prints'
: > "$tree/kernels/new.h"
expect_fault 'kernels/new.h: not listed'
: > "$tree/src/IO/New.cc"
expect_fault 'src/IO/New.cc: not listed'
: > "$tree/src/IO/New.hh"
expect_fault 'src/IO/New.hh: not listed'
echo '#include "hfremesh/IO/Read.hh"' >> "$tree/src/HalfFace/Mesh.hh"
expect_fault 'src/HalfFace/Mesh.hh:1: HalfFace stands below'
echo '#include <hfremesh/IO/Inner.hh>' >> "$tree/apps/hfremesh/main.cc"
expect_fault 'apps/hfremesh/main.cc:4: IO/Inner.hh is not a public header'
echo '#include <IO/Read.hh>' >> "$tree/apps/hfremesh/main.cc"
expect_fault 'apps/hfremesh/main.cc:4: users know IO/Read.hh as hfremesh/IO/Read.hh'
echo '#include "IO/Inner.hh"' >> "$tree/src/IO/Read.hh"
expect_fault 'src/IO/Read.hh:2: IO/Inner.hh is not a public header'
echo '#include "HalfFace/Mesh.hh"' >> "$tree/src/IO/Read.hh"
expect_fault 'src/IO/Read.hh:2: users know HalfFace/Mesh.hh as hfremesh/HalfFace/Mesh.hh'
if command -v git > /dev/null; then
  git -C "$tree" init -q
  head -c 1100000 /dev/zero > "$tree/out put.vtu"
  git -C "$tree" add .
  expect_fault 'out put.vtu: no file of 1100000 bytes is tracked'
  rm -rf "$tree/.git" "$tree/out put.vtu"
fi
"$check" "$tree" > /dev/null
exit "$failed"

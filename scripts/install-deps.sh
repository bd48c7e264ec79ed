#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the Debian or Ubuntu packages that hfremesh needs and that are missing. Does nothing, and asks for
# no rights, when all are there.
# Usage: scripts/install-deps.sh [--tool] [--bench] [--same-bits] [--libcxx] [--fortran] [--python] [--dev] [--deb]
#                                [--packaging] [--mpi] [--mpich] [--petsc]
#   (none)   to build the library, the tool and the tests
#   --tool   to build the library and the tool only
#   --bench  the default, and the benchmarks
#   --same-bits  the default, and the other compiler and thread library of scripts/same-bits.sh
#   --libcxx the default, and clang with its own standard library, for scripts/libcxx.sh
#   --fortran  the default, and gfortran, for the tests of the Fortran module, which are not there without
#   --python the default, and headers and virtual environments of Python 3, for pip install and scripts/python.sh
#   --deb    the default, and what makes Debian packages, for scripts/deb.sh
#   --dev    the default, and what the scripts for developers call: clang, clang-tidy, clang-format, gcovr;
#            gfortran, for the tests of the Fortran module, and chromium, for that of the page of --report, which are
#            skipped without
#   --mpi    the default, and what several ranks take (HFR_MPI): Open MPI and PT-Scotch, for scripts/mpi.sh
#   --mpich  the default, and MPICH instead of Open MPI, for scripts/mpi.sh --mpich: both may be there
#   --petsc  those of --mpi, and PETSc for real numbers with petsc4py (HFR_PETSC), for scripts/petsc.sh
#   --packaging  the default, and what makes and checks packages, manual and completions: lintian and debhelper for
#            scripts/deb.sh, abigail-tools for scripts/abi.sh, doxygen for scripts/site.sh; zsh, fish and mandoc for
#            their tests
# oclgrind comes with the tests where it can be had; where not, the search for faults of kernels is skipped.
set -euo pipefail

packages=(g++ cmake make pkg-config zlib1g-dev libfmt-dev libtinyxml2-dev nlohmann-json3-dev libcli11-dev
  libeigen3-dev libopenmesh-dev libpng-dev opencl-headers opencl-clhpp-headers ocl-icd-libopencl1 pocl-opencl-icd)
tests=(libgtest-dev libgmock-dev)
optional=(oclgrind)
extra=()
for option in "$@"; do
  case $option in
    --tool) tests=() optional=() ;;
    --bench) extra+=(libbenchmark-dev) ;;
    --same-bits) extra+=(clang libomp-dev libtbb-dev) ;;
    --python) extra+=(python3-dev python3-venv) ;;
    --deb) extra+=(dpkg-dev file) ;;
    --fortran) extra+=(gfortran) ;;
    --libcxx) extra+=(clang libc++-dev libc++abi-dev) ;;
    --dev) extra+=(ninja-build clang libomp-dev clang-tidy-14 clang-format-14 gcovr gfortran chromium) ;;
    --mpi) extra+=(libopenmpi-dev openmpi-bin libptscotch-dev) ;;
    --mpich) extra+=(libmpich-dev mpich) ;;
    --petsc) extra+=(libopenmpi-dev openmpi-bin libptscotch-dev libpetsc-real-dev python3-petsc4py-real) ;;
    --packaging) extra+=(dpkg-dev debhelper lintian abigail-tools doxygen zsh fish mandoc) ;;
    *) sed -n '3,25s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 1 ;;
  esac
done
packages+=("${tests[@]}" "${extra[@]}")

if ! command -v dpkg-query > /dev/null; then
  echo "install-deps: no dpkg here, so nothing was checked; needed are: ${packages[*]}" >&2
  exit 0
fi

is_missing() {
  # A package of several architectures prints one line for each.
  local status
  status=$(dpkg-query -W -f='${db:Status-Status}\n' "$1" 2> /dev/null || true)
  ! grep -qx installed <<< "$status"
}
missing=() wished=()
for package in "${packages[@]}"; do is_missing "$package" && missing+=("$package"); done
for package in "${optional[@]}"; do is_missing "$package" && wished+=("$package"); done
[ ${#missing[@]} -eq 0 ] && [ ${#wished[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo > /dev/null || { [ ! -t 0 ] && ! sudo -n true 2> /dev/null; }; then
    if [ ${#missing[@]} -eq 0 ]; then
      echo "install-deps: going on without ${wished[*]}, which an administrator could install"
      exit 0
    fi
    echo "install-deps: ask an administrator to install these packages: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

install() {
  echo "install-deps: installing $*"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" \
    < /dev/null
}
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq ||
  [ ${#missing[@]} -eq 0 ]
if [ ${#missing[@]} -gt 0 ]; then install "${missing[@]}"; fi
if [ ${#wished[@]} -gt 0 ] && ! install "${wished[@]}"; then
  echo "install-deps: going on without ${wished[*]}, which this archive does not have"
fi

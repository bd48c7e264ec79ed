// SPDX-License-Identifier: BSD-3-Clause
#include <petscsys.h>

#include "QuietRanks.hh"
#include "hfremesh_petsc.h"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  for (int twice = 0; twice < 2; ++twice) PetscCall(hfremesh_petsc_register());
  PetscCall(PetscOptionsSetValue(nullptr, "-dm_adaptor", "hfremesh"));
  const int failed = hfr::test::run_tests_on_ranks();
  PetscCall(PetscFinalize());
  return failed;
}

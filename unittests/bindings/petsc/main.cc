// SPDX-License-Identifier: BSD-3-Clause
// All ranks run all tests together. The first one reports; the others say only what has failed on them.
#include <gtest/gtest.h>
#include <petscsys.h>

#include <cstdio>

#include "hfremesh_petsc.h"

namespace {

class Failures : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (result.failed())
      std::fprintf(stderr, "%s:%d: %s\n", result.file_name(), result.line_number(), result.message());
  }
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  for (int twice = 0; twice < 2; ++twice) PetscCall(hfremesh_petsc_register());
  PetscCall(PetscOptionsSetValue(nullptr, "-dm_adaptor", "hfremesh"));
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank != 0) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new Failures);
  }
  const int failed = RUN_ALL_TESTS();
  PetscCall(PetscFinalize());
  return failed;
}

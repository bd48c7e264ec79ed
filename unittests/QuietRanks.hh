// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_QUIET_RANKS_HH
#define HFR_UNITTESTS_QUIET_RANKS_HH

#include <gtest/gtest.h>
#include <mpi.h>

#include <cstdio>

namespace hfr::test {

class PrintFailures : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (result.failed())
      std::fprintf(stderr, "%s:%d: %s\n", result.file_name(), result.line_number(), result.message());
  }
};

/// All ranks run all tests together. The first one reports; the others say only what has failed on them.
inline int run_tests_on_ranks() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank != 0) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new PrintFailures);
  }
  return RUN_ALL_TESTS();
}

}  // namespace hfr::test

#endif

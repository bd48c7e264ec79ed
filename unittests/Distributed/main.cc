// SPDX-License-Identifier: BSD-3-Clause
#include <mpi.h>

#include "QuietRanks.hh"

int main(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &level);
  testing::InitGoogleTest(&argc, argv);
  const int failed = hfr::test::run_tests_on_ranks();
  MPI_Finalize();
  return failed;
}

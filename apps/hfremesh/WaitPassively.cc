// SPDX-License-Identifier: BSD-3-Clause
#include "WaitPassively.hh"

#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

void hfr::app::wait_passively(char** argv) {
  if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT") || getenv("KMP_BLOCKTIME")) return;
  if (setenv("OMP_WAIT_POLICY", "passive", 1) != 0 || setenv("GOMP_SPINCOUNT", "1000", 1) != 0) return;
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) execv(self.c_str(), argv);  // returns only on failure: go on as we are
}

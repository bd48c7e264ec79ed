// SPDX-License-Identifier: BSD-3-Clause
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "Tool.hh"

namespace {

/// Idle OpenMP threads that spin make short parallel loops many times slower on a busy machine. The run-time
/// library reads how to wait before main() starts, so the process has to start once more to change it.
/// Whoever sets one of the variables has decided, and is left alone.
void wait_passively(char** argv) {
  if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT") || getenv("KMP_BLOCKTIME")) return;
  if (setenv("OMP_WAIT_POLICY", "passive", 1) != 0) return;
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) execv(self.c_str(), argv);  // returns only on failure: go on as we are
}

}  // namespace

int main(int argc, char** argv) {
  wait_passively(argv);
  return static_cast<int>(hfr::app::run_tool(argc, argv));
}

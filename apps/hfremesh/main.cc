// SPDX-License-Identifier: BSD-3-Clause
#include "Tool.hh"
#include "WaitPassively.hh"

int main(int argc, char** argv) {
  hfr::app::wait_passively(argv);
  return static_cast<int>(hfr::app::run_tool(argc, argv));
}

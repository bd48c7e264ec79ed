// SPDX-License-Identifier: BSD-3-Clause
#include "Locks.hh"

#include "ExitCode.hh"
#include "Numbers.hh"
#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/Remesh/NamedOptions.hh"

namespace hfr::app {
namespace {

void set(ImproveOptions& options, const char* name, const std::string& value, const char* what_it_takes) {
  try {
    set_option(options, name, value);
  } catch (const InvalidInput&) {
    throw Failure(ExitCode::kUsage,
                  "--" + std::string(name) + " takes " + what_it_takes + ", not " + in_quotes(value));
  }
}

}  // namespace

void add_locks(SurfaceOptions& surface, const std::vector<std::string>& fix,
               const std::vector<std::string>& periodic) {
  ImproveOptions options;
  options.surface = surface;
  for (const std::string& what : fix) set(options, "fix", what, "patch:N, vertex:N, edge:N-N and face:N-N-N");
  for (const std::string& pair : periodic) set(options, "periodic", pair, "A:B, two patches");
  surface = options.surface;
}

}  // namespace hfr::app

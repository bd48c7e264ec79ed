// SPDX-License-Identifier: BSD-3-Clause
#include "ExitCode.hh"

#include <new>

#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::app {

ExitCode exit_code_of(const std::exception& error) {
  if (const auto* failure = dynamic_cast<const Failure*>(&error)) return failure->code();
  if (dynamic_cast<const InvalidInput*>(&error)) return ExitCode::kUsage;
  if (dynamic_cast<const IoError*>(&error)) return ExitCode::kUsage;  // of an output: inputs have their own
  if (dynamic_cast<const ResourceLimit*>(&error)) return ExitCode::kLimit;
  if (dynamic_cast<const std::bad_alloc*>(&error)) return ExitCode::kLimit;
  if (dynamic_cast<const std::length_error*>(&error)) return ExitCode::kLimit;
  if (dynamic_cast<const DeviceError*>(&error)) return ExitCode::kDevice;
  return ExitCode::kInternal;
}

std::string message_of(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error)) return "not enough memory";
  return error.what();
}

}  // namespace hfr::app

// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_EXIT_CODE_HH
#define HFR_APPS_EXIT_CODE_HH

#include <exception>
#include <stdexcept>
#include <string>

namespace hfr::app {

/// What the tool tells the shell; docs/exit-codes.md says the same to users.
enum class ExitCode {
  kDone = 0,          ///< done, and every goal is met
  kUsage = 1,         ///< the command line is wrong, or names an output that cannot be written
  kCannotRead = 2,    ///< the input is missing, broken or not supported
  kGoalMissed = 3,    ///< the mesh is valid, but a goal is missed
  kInvalidCells = 4,  ///< the mesh has invalid cells
  kLimit = 5,         ///< the time or memory limit was met
  kDevice = 6,        ///< no device of the kind that was asked for, or it failed
  kInternal = 7,      ///< anything else; nothing was written
  kCancelled = 130,   ///< stopped by SIGINT or SIGTERM
};

/// An error whose exit code is known where it is thrown. what() is one line.
class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// What an exception that nobody caught means to the shell.
ExitCode exit_code_of(const std::exception& error);
/// One line about it for the user.
std::string message_of(const std::exception& error);

}  // namespace hfr::app

#endif

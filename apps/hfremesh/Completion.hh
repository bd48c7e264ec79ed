// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_COMPLETION_HH
#define HFR_APPS_COMPLETION_HH

#include <string>

#include "Help.hh"

/// What shells complete after the name of the program: subcommands, options, values where they are a list,
/// and files.
namespace hfr::app {

/// Each is the text of a file for the shell to read.
std::string bash_completion(const CommandFacts& program);
std::string zsh_completion(const CommandFacts& program);
std::string fish_completion(const CommandFacts& program);

}  // namespace hfr::app

#endif

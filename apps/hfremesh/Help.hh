// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_HELP_HH
#define HFR_APPS_HELP_HH

#include <string>
#include <vector>

/// The command line as data, and what is made of it for readers and shells: --help, the man page,
/// completions.
namespace hfr::app {

/// A line that can be typed, and what it does.
struct Example {
  std::string command, what;
};

struct OptionFacts {
  std::string group;               ///< heading that it stands under
  std::vector<std::string> names;  ///< "-o", "--output"; empty for what is known by its place alone
  std::string place;               ///< name of the place, "IN"; empty for none
  std::string value;  ///< what stands for the value, with its unit: "FILE", "DEG"; empty for a flag
  std::vector<std::string> choices;  ///< all values that there are; empty where they are not a list
  std::string help;
  std::string standard;  ///< value where none is given; empty where the help says it, or there is none
  bool required = false;

  bool is_place() const { return !place.empty(); }
};

struct CommandFacts {
  std::string path;  ///< "hfremesh improve"
  std::string name;  ///< "improve"
  std::string help;
  std::vector<Example> examples;
  std::vector<OptionFacts> options;  ///< in the order in which they were added
  std::vector<CommandFacts> subcommands;

  /// Headings of the options, each once, in the order of their first option.
  std::vector<std::string> groups() const;
};

/// What --help prints: examples, usage, then the options by group; at most 80 columns where words allow.
std::string help_text(const CommandFacts& command);

/// The name of the option with its value: "-o, --output FILE".
std::string spelled(const OptionFacts& option);
/// Help, values and default in one text.
std::string explained(const OptionFacts& option);
/// One line: "hfremesh improve [options] IN".
std::string usage(const CommandFacts& command);

}  // namespace hfr::app

#endif

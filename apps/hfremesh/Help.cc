// SPDX-License-Identifier: BSD-3-Clause
#include "Help.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

namespace hfr::app {
namespace {

constexpr std::size_t kWidth = 80;   // columns of a page
constexpr std::size_t kIndent = 28;  // column at which an option's text begins

/// Words of `text` in lines of at most kWidth columns, each but the first after `indent` blanks. The first
/// begins at column `at`.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t at) {
  std::istringstream words(text);
  std::string out, word;
  bool begun = false;
  while (words >> word) {
    if (begun && at + 1 + word.size() > kWidth) {
      out += "\n" + std::string(indent, ' ');
      at = indent;
    } else if (begun) {
      out += ' ';
      ++at;
    }
    out += word;
    at += word.size();
    begun = true;
  }
  return out;
}

/// A name, and its text in a column of its own.
std::string row(const std::string& name, const std::string& text) {
  std::string line = "  " + name;
  if (line.size() + 2 > kIndent)
    line += "\n" + std::string(kIndent, ' ');
  else
    line.resize(kIndent, ' ');
  return line + wrapped(text, kIndent, kIndent) + "\n";
}

}  // namespace

std::vector<std::string> CommandFacts::groups() const {
  std::vector<std::string> names;
  for (const OptionFacts& option : options)
    if (std::find(names.begin(), names.end(), option.group) == names.end()) names.push_back(option.group);
  return names;
}

std::string spelled(const OptionFacts& option) {
  const std::string names = fmt::format("{}", fmt::join(option.names, ", "));
  if (option.is_place()) return names.empty() ? option.value : option.place + ", " + names;
  return option.value.empty() ? names : names + " " + option.value;
}

std::string explained(const OptionFacts& option) {
  std::string text = option.help;
  if (!option.choices.empty()) text += fmt::format(" {{{}}}", fmt::join(option.choices, ", "));
  if (option.required) text += " (required)";
  if (!option.standard.empty()) text += fmt::format(" [default: {}]", option.standard);
  return text;
}

std::string usage(const CommandFacts& command) {
  std::string line = command.path;
  if (!command.subcommands.empty()) return line + " SUBCOMMAND ...";
  line += " [options]";
  for (const OptionFacts& option : command.options) {
    if (option.is_place()) {
      const std::string& place = option.names.empty() ? option.value : option.place;
      line += option.required ? " " + place : " [" + place + "]";
    } else if (option.required) {
      line += fmt::format(" {} {}", option.names.front(), option.value);
    }
  }
  return line;
}

std::string help_text(const CommandFacts& command) {
  std::string out = wrapped(command.help, 0, 0) + "\n";
  if (!command.examples.empty()) out += "\nExamples:\n";
  for (const Example& example : command.examples)
    out += fmt::format("  # {}\n  {}\n", example.what, example.command);
  out += "\nUsage: " + usage(command) + "\n";
  if (!command.subcommands.empty()) out += "\nSubcommands (each has its own --help):\n";
  for (const CommandFacts& subcommand : command.subcommands) out += row(subcommand.name, subcommand.help);
  for (const std::string& group : command.groups()) {
    out += "\n" + group + ":\n";
    for (const OptionFacts& option : command.options)
      if (option.group == group) out += row(spelled(option), explained(option));
  }
  return out;
}

}  // namespace hfr::app

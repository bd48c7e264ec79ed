// SPDX-License-Identifier: BSD-3-Clause
// The man page and the completions, made of the options that the program has.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "Commands.hh"
#include "Completion.hh"
#include "Console.hh"
#include "Help.hh"
#include "hfremesh/HalfFace/Config.hh"

namespace hfr::app {
namespace {

/// Text as roff has it: no line begins with a request, and a minus is one that can be copied.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) {
      out += std::string("\\&") + c;
    } else {
      out += c;
    }
  }
  return out;
}

void add_options(const CommandFacts& command, std::string& out) {
  for (const std::string& group : command.groups()) {
    out += ".PP\n\\fI" + roff(group) + "\\fR\n";
    for (const OptionFacts& option : command.options)
      if (option.group == group)
        out += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(spelled(option)), roff(explained(option)));
  }
}

void add_command(const CommandFacts& command, std::string& out) {
  out += fmt::format(".SS {}\n{}.\n.PP\n\\fB{}\\fR\n", roff(command.path), roff(command.help),
                     roff(usage(command)));
  for (const Example& example : command.examples)
    out += fmt::format(".PP\n{}:\n.PP\n.nf\n.RS\n{}\n.RE\n.fi\n", roff(example.what), roff(example.command));
  add_options(command, out);
  for (const CommandFacts& below : command.subcommands) add_command(below, out);
}

std::string man_page(const CommandFacts& program) {
  std::string out = fmt::format(".TH HFREMESH 1 \"\" \"hfremesh {}\" \"User Commands\"\n", HFR_VERSION);
  out += ".SH NAME\nhfremesh \\- repairs and improves tetrahedral meshes\n.SH SYNOPSIS\n";
  out += ".nf\n\\fBhfremesh\\fR IN \\-o OUT [options]\n\\fBhfremesh\\fR SUBCOMMAND [options] ...\n.fi\n";
  out += ".SH DESCRIPTION\n" + roff(program.help) +
         "\n.PP\nUnits: DEG is degrees of an angle, dihedral where not said otherwise; S is seconds; LENGTH "
         "is in the "
         "unit of the mesh. FILE may be \\- for a standard stream. Ids count from 0. The output is the same "
         "for every "
         "number of threads.\n.SH EXAMPLES\n";
  for (const Example& example : program.examples)
    out += fmt::format(".PP\n{}:\n.PP\n.nf\n.RS\n{}\n.RE\n.fi\n", roff(example.what), roff(example.command));
  out += ".SH OPTIONS\n";
  add_options(program, out);
  out += ".SH SUBCOMMANDS\n";
  for (const CommandFacts& below : program.subcommands) add_command(below, out);
  out += ".SH EXIT STATUS\n";
  constexpr std::pair<const char*, const char*> kCodes[] = {
      {"0", "done, and every goal is met"},
      {"1", "the command line is wrong, or an output or a report cannot be written"},
      {"2", "the input cannot be read, or no mesh can be made of it"},
      {"3", "the mesh is valid, but a goal is missed"},
      {"4", "the mesh has invalid cells"},
      {"5", "the time limit was met, or memory ran out"},
      {"6", "the device that was asked for by name is missing, or failed"},
      {"7", "an internal error; nothing was written"},
      {"130", "cancelled by a signal; the mesh so far is written"}};
  for (const auto& [code, what] : kCodes) out += fmt::format(".TP\n\\fB{}\\fR\n{}\n", code, roff(what));
  return out;
}

std::string text_of(const std::string& kind, const CommandFacts& program) {
  if (kind == "bash") return bash_completion(program);
  if (kind == "zsh") return zsh_completion(program);
  if (kind == "fish") return fish_completion(program);
  return man_page(program);
}

}  // namespace

Subcommand add_manual(Command program, CommonOptions& common) {
  const auto kind = std::make_shared<std::string>();
  Command command = program.subcommand("manual", "Print the man page, or a shell's completions");
  command.example("source <(hfremesh manual bash)", "complete options and files in this shell");
  command.group("What");
  command.option("KIND", *kind, "man, or the shell").required().one_of({"man", "bash", "zsh", "fish"});
  add_common_options(command, common);
  return {command, [] { return std::vector<FileUse>(); },
          [kind, program](nlohmann::ordered_json&) {
            print("{}", text_of(*kind, program.facts()));
            return ExitCode::kDone;
          }};
}

}  // namespace hfr::app

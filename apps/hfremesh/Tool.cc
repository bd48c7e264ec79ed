// SPDX-License-Identifier: BSD-3-Clause
#include "Tool.hh"

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "Commands.hh"
#include "Console.hh"
#include "Files.hh"
#include "Json.hh"
#include "Paths.hh"
#include "Signals.hh"
#include "Threads.hh"
#include "hfremesh/HalfFace/Config.hh"

namespace hfr::app {
namespace {

/// Left to itself glibc keeps arrays of up to 32 MiB in its heap once some were freed, where the holes that
/// they leave add a fifth to the peak memory of a run. Each gets pages of its own instead, and gives them
/// back.
void give_memory_back() {
#ifdef __GLIBC__
  constexpr int kOwnPages = 1 << 20;  // bytes
  mallopt(M_MMAP_THRESHOLD, kOwnPages);
#endif
}

constexpr const char* kSubcommands[] = {"improve", "move",     "check",   "stats", "report",
                                        "convert", "generate", "devices", "manual"};

/// The arguments. "hfremesh IN -o OUT" is short for "hfremesh improve IN -o OUT".
std::vector<std::string> arguments(int argc, char** argv, const Variant& variant) {
  std::vector<std::string> args(argv + 1, argv + argc);
  std::vector<std::string> own_flags = {"--version"};
  if (!variant.add_options) own_flags.insert(own_flags.end(), {"-h", "--help"});
  const auto is_one_of = [](const auto& list, const std::string& word) {
    return std::find(std::begin(list), std::end(list), word) != std::end(list);
  };
  if (!args.empty() && !is_one_of(kSubcommands, args[0]) && !is_one_of(own_flags, args[0]))
    args.insert(args.begin(), "improve");
  return args;
}

/// Looks at all files before any is read; nothing is written where two of them are one, the report included.
void check_files(const Subcommand& subcommand, CommonOptions& common) {
  std::vector<FileUse> files = subcommand.files();
  files.push_back({FileUse::Kind::kReport, "--json", common.json});
  require_apart(files, common);
  if (!common.json.empty()) require_writable(common.json);
  for (const FileUse& use : files)
    if (use.kind != FileUse::Kind::kInput && use.path == "-" && use.is_used) common.stdout_taken = true;
}

/// Fewer threads than were asked for are no reason to fail: the result is the same.
std::vector<std::string> limit_threads(CommonOptions& common) {
  const int wanted = common.policy().threads;
  common.threads = usable_threads(wanted);
  if (common.threads == wanted) return {};
  return {fmt::format("{} threads cannot be made here; {} are used", wanted, common.threads)};
}

/// Runs the command; what it throws becomes its exit code, a line and a part of the report.
ExitCode run_command(const Subcommand& subcommand, CommonOptions& common, Json& report) {
  try {
    const std::vector<std::string> notes = limit_threads(common);
    report["threads"] = common.policy().threads;
    const ExitCode code = subcommand.run(report);
    if (!common.quiet) print_notes(notes);
    for (const std::string& note : notes) report["notes"].push_back(note);
    return code;
  } catch (const std::exception& error) {
    print_error(message_of(error));
    report["error"] = message_of(error);
    return exit_code_of(error);
  }
}

ExitCode run(const Subcommand& subcommand, CommonOptions& common, StandardStreams& streams) {
  Json report = new_report(subcommand.command.name());
  try {
    check_files(subcommand, common);
  } catch (const std::exception& error) {
    print_error(message_of(error));
    return exit_code_of(error);
  }
  ExitCode code = run_command(subcommand, common, report);
  if (!streams.arrived() && code == ExitCode::kDone) code = ExitCode::kUsage;
  if (common.json.empty()) return code;
  report["exit_code"] = static_cast<int>(code);
  return save_report(
      common.json, [&] { return json_text(report); }, code);
}

/// The parser quotes arguments in full, however long they are.
std::string shortened(const std::string& message) {
  constexpr std::size_t kLongest = 300;
  return message.size() > kLongest ? message.substr(0, kLongest) + "..." : message;
}

/// Name of the subcommand that was being parsed, for the hint after an error.
std::string parsed_command(const std::vector<Subcommand>& subcommands) {
  for (const Subcommand& subcommand : subcommands)
    if (subcommand.command.parsed()) return subcommand.command.name() + " ";
  return "";
}

ExitCode parse_and_run(int argc, char** argv, StandardStreams& streams, const Variant& variant) {
  Parser parser(
      variant.name,
      "Repairs and improves tetrahedral meshes. 'hfremesh IN -o OUT' is short for 'hfremesh improve "
      "IN -o OUT'.",
      variant.name + " " + HFR_VERSION);
  Command program = parser.program();
  program.require_subcommand();
  program.example("hfremesh bad.mesh -o good.mesh", "improve; size, boundary and tags stay");
  program.example("hfremesh bad.msh -o good.vtu --min-dihedral 20",
                  "work only on cells that miss 20 degrees");
  program.example("hfremesh check good.vtu", "inverted, flat, overlapping, broken? the exit code says");
  program.example("hfremesh stats bad.mesh good.mesh", "figures side by side");
  program.example("hfremesh generate cavity -o bad.mesh", "a mesh with inverted cells, to try it on");
  CommonOptions common;
  common.threads = variant.threads;
  if (variant.improve) common.improve = variant.improve;
  const std::vector<Subcommand> subcommands = {
      add_improve(program, common),  add_move(program, common),    add_check(program, common),
      add_stats(program, common),    add_report(program, common),  add_convert(program, common),
      add_generate(program, common), add_devices(program, common), add_manual(program, common)};
  if (variant.add_options) {
    Command command = subcommands.front().command;
    variant.add_options(command);
  }
  try {
    if (argc < 2) throw Failure(ExitCode::kUsage, "a mesh or a subcommand is required");
    if (!parser.parse(arguments(argc, argv, variant))) return ExitCode::kDone;
  } catch (const Failure& error) {
    print_error(fmt::format("{}; try '{} {}--help'", shortened(error.what()), variant.name,
                            parsed_command(subcommands)));
    return error.code();
  }
  for (const Subcommand& subcommand : subcommands)
    if (subcommand.command.parsed()) return run(subcommand, common, streams);
  return ExitCode::kInternal;
}

}  // namespace
}  // namespace hfr::app

hfr::app::ExitCode hfr::app::run_tool(int argc, char** argv, const Variant& variant) {
  give_memory_back();
  StandardStreams streams;
  handle_signals();
  ExitCode code = ExitCode::kInternal;
  try {
    code = parse_and_run(argc, argv, streams, variant);
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  if (!streams.arrived() && code == ExitCode::kDone) code = ExitCode::kUsage;
  return code;
}

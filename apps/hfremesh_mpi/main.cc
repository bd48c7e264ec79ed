// SPDX-License-Identifier: BSD-3-Clause
// hfremesh on several ranks: rank 0 is the tool, the others do their share of its passes.
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Tool.hh"
#include "hfremesh/Distributed/Improve.hh"

namespace {

using hfr::app::ExitCode;

/// Ranks have one thread each unless the command line says how many. Whoever asks what there is has none.
bool says_threads(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc, [](std::string_view arg) {
    return arg.starts_with("--threads") || arg.starts_with("-j") || arg == "--version" || arg == "--help" ||
           arg == "-h" || arg == "manual";
  });
}

/// What the tool has no option for.
struct OwnOptions {
  hfr::mpi::Sharing sharing;
  bool shows_traffic = false;
};

/// Takes the own options out of the arguments and leaves the others as they are. Throws CLI::ParseError.
OwnOptions take_own_options(std::vector<std::string>& args) {
  using hfr::mpi::Partition;
  const std::map<std::string, Partition> partitions = {{"coordinates", Partition::kCoordinates},
                                                       {"graph", Partition::kGraph},
                                                       {"numbers", Partition::kNumbers}};
  OwnOptions own;
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  app.add_option("--share-from", own.sharing.least_cells)->check([](const std::string& text) {
    const bool is_number = !text.empty() && text.size() < 19 &&
                           std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
    return is_number ? std::string() : "must be a whole number";
  });
  std::string partition = "coordinates";
  app.add_option("--partition", partition)->check([&](const std::string& text) {
    return partitions.contains(text) ? std::string() : "must be coordinates, graph or numbers";
  });
  app.add_flag("--traffic", own.shows_traffic);
  std::vector<std::string> reversed(args.rbegin(), args.rend());  // as CLI11 takes them
  app.parse(std::move(reversed));
  args = app.remaining();
  own.sharing.partition = partitions.at(partition);
  return own;
}

/// For --traffic: a line for each rank, then one for each phase.
void print_figures(std::span<const hfr::mpi::RankFigures> ranks) {
  using hfr::mpi::Traffic;
  const auto n = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    Traffic sum;
    for (const Traffic& one : ranks[r].traffic) sum += one;
    std::fprintf(
        stderr,
        "hfremesh-mpi: rank %zu: sent %llu messages of %llu bytes in %llu exchanges, %llu collectives of "
        "%llu bytes; %llu rounds; part: %llu own cells, %llu held, %llu near others; peak memory %llu "
        "bytes\n",
        r, n(sum.messages), n(sum.bytes), n(sum.exchanges), n(sum.collectives), n(sum.collective_bytes),
        n(ranks[r].n_rounds), n(ranks[r].n_own), n(ranks[r].n_held), n(ranks[r].n_border),
        n(ranks[r].peak_bytes));
  }
  for (std::size_t p = 0; p < hfr::mpi::kPhaseNames.size(); ++p) {
    double slowest = 0;
    Traffic most;
    for (const auto& rank : ranks) {
      slowest = std::max(slowest, rank.seconds[p]);
      most.messages = std::max(most.messages, rank.traffic[p].messages);
      most.bytes = std::max(most.bytes, rank.traffic[p].bytes);
      most.exchanges = std::max(most.exchanges, rank.traffic[p].exchanges + rank.traffic[p].collectives);
      most.collective_bytes = std::max(most.collective_bytes, rank.traffic[p].collective_bytes);
    }
    std::fprintf(
        stderr,
        "hfremesh-mpi: phase %s: %.3f s on rank 0, %.3f s on the slowest; of a rank at most %llu messages "
        "of %llu bytes, %llu bytes to all, %llu calls\n",
        hfr::mpi::kPhaseNames[p], ranks[0].seconds[p], slowest, n(most.messages), n(most.bytes),
        n(most.collective_bytes), n(most.exchanges));
  }
}

/// Rank 0. What another rank throws becomes an error of the tool, with the exit code that it has there.
int lead(int argc, char** argv, hfr::mpi::Comm& comm) {
  std::vector<std::string> args(argv + 1, argv + argc);
  OwnOptions own;
  try {
    own = take_own_options(args);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "hfremesh-mpi: %s\n", error.what());
    const int code = static_cast<int>(ExitCode::kUsage);
    hfr::mpi::dismiss(comm, code);
    return code;
  }
  if (argc > 1 && !says_threads(argc, argv) && comm.size() > 1) args.insert(args.end(), {"--threads", "1"});
  std::vector<char*> pointers = {argv[0]};
  for (std::string& arg : args) pointers.push_back(arg.data());
  pointers.push_back(nullptr);
  if (own.shows_traffic) own.sharing.tell_figures = print_figures;
  bool are_gone = false, has_thrown = false;
  const auto improve = [&](hfr::TetMesh& mesh, const hfr::ImproveOptions& options) {
    try {
      return hfr::mpi::improve(mesh, options, comm, own.sharing);
    } catch (const hfr::mpi::RankFailed& failed) {
      are_gone = true;
      throw hfr::app::Failure(static_cast<ExitCode>(failed.code()), failed.what());
    } catch (...) {
      has_thrown = true;  // others may be in the midst of a pass
      throw;
    }
  };
  const int code =
      static_cast<int>(hfr::app::run_tool(static_cast<int>(pointers.size()) - 1, pointers.data(), improve));
  if (are_gone) return code;
  if (has_thrown)
    comm.fail(code, "the tool has ended");
  else
    hfr::mpi::dismiss(comm, code);
  return code;
}

/// The other ranks, which print nothing: rank 0 tells what has happened to them.
int follow(hfr::mpi::Comm& comm) {
  try {
    return hfr::mpi::serve(comm);
  } catch (const hfr::mpi::RankFailed& failed) {
    return failed.code();
  } catch (const std::exception& error) {
    return comm.fail(static_cast<int>(hfr::app::exit_code_of(error)), hfr::app::message_of(error)).code();
  }
}

}  // namespace

int main(int argc, char** argv) {
  // Ranks share cores with threads: who waits sleeps.
  setenv("OMP_WAIT_POLICY", "passive", 0);
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &level);
  int code = 0;
  {
    hfr::mpi::Comm comm(MPI_COMM_WORLD);
    code = comm.rank() == 0 ? lead(argc, argv, comm) : follow(comm);
  }
  MPI_Finalize();
  return code;
}

// SPDX-License-Identifier: BSD-3-Clause
// hfremesh on several ranks: rank 0 is the tool, the others do their share of its passes.
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>
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

/// Takes "--share-from N" and "--partition HOW", which the tool has not, out of the arguments.
hfr::mpi::Sharing take_sharing(std::vector<char*>& args) {
  hfr::mpi::Sharing sharing;
  for (std::size_t i = 1; i + 1 < args.size();) {
    const std::string_view name = args[i], value = args[i + 1];
    if (name == "--share-from")
      sharing.least_cells = std::strtoull(args[i + 1], nullptr, 10);
    else if (name == "--partition" && value == "graph")
      sharing.partition = hfr::mpi::Partition::kGraph;
    else if (name == "--partition" && value == "coordinates")
      sharing.partition = hfr::mpi::Partition::kCoordinates;
    else if (name == "--partition" && value == "numbers")
      sharing.partition = hfr::mpi::Partition::kNumbers;
    else {
      ++i;
      continue;
    }
    args.erase(args.begin() + static_cast<std::ptrdiff_t>(i),
               args.begin() + static_cast<std::ptrdiff_t>(i) + 2);
  }
  return sharing;
}

/// What ranks have said to each other, for --traffic.
void print_traffic(const hfr::mpi::Comm& comm) {
  const hfr::mpi::Traffic& t = comm.traffic();
  std::fprintf(stderr,
               "hfremesh-mpi: rank %d: %llu messages of %llu bytes in %llu exchanges, %llu collectives of "
               "%llu bytes\n",
               comm.rank(), static_cast<unsigned long long>(t.messages),
               static_cast<unsigned long long>(t.bytes), static_cast<unsigned long long>(t.exchanges),
               static_cast<unsigned long long>(t.collectives),
               static_cast<unsigned long long>(t.collective_bytes));
}

/// Rank 0. What another rank throws becomes an error of the tool, with the exit code that it has there.
int lead(int argc, char** argv, hfr::mpi::Comm& comm) {
  std::vector<char*> args(argv, argv + argc);
  const hfr::mpi::Sharing sharing = take_sharing(args);
  const auto traffic =
      std::find_if(args.begin(), args.end(), [](std::string_view arg) { return arg == "--traffic"; });
  const bool shows_traffic = traffic != args.end();
  if (shows_traffic) args.erase(traffic);
  char option[] = "--threads", one[] = "1";
  if (argc > 1 && !says_threads(argc, argv) && comm.size() > 1) {
    args.push_back(option);
    args.push_back(one);
  }
  args.push_back(nullptr);
  bool are_gone = false, has_thrown = false;
  const auto improve = [&](hfr::TetMesh& mesh, const hfr::ImproveOptions& options) {
    try {
      return hfr::mpi::improve(mesh, options, comm, sharing);
    } catch (const hfr::mpi::RankFailed& failed) {
      are_gone = true;
      throw hfr::app::Failure(static_cast<ExitCode>(failed.code()), failed.what());
    } catch (...) {
      has_thrown = true;  // others may be in the midst of a pass
      throw;
    }
  };
  const int code =
      static_cast<int>(hfr::app::run_tool(static_cast<int>(args.size()) - 1, args.data(), improve));
  if (shows_traffic) print_traffic(comm);
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

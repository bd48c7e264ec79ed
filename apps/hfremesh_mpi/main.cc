// SPDX-License-Identifier: BSD-3-Clause
// hfremesh on several ranks: rank 0 is the tool, the others do their share of its passes.
#include <mpi.h>

#include <cstdio>
#include <exception>
#include <limits>
#include <string>

#include "InParts.hh"
#include "Numbers.hh"
#include "PrintFigures.hh"
#include "Tool.hh"
#include "WaitPassively.hh"
#include "hfremesh/Distributed/Cores.hh"
#include "hfremesh/Distributed/Improve.hh"
#include "hfremesh/Distributed/Partition.hh"

namespace {

using hfr::app::ExitCode;

/// What the tool has no option for.
struct OwnOptions {
  static constexpr unsigned long kByRule = std::numeric_limits<unsigned long>::max();
  unsigned long share_from = kByRule;
  int threads_each = 1;
  std::string partition = "coordinates";
  bool shows_traffic = false;

  hfr::mpi::Sharing sharing() const {
    using hfr::mpi::Partition;
    hfr::mpi::Sharing sharing;
    if (partition == "graph") sharing.partition = Partition::kGraph;
    if (partition == "numbers") sharing.partition = Partition::kNumbers;
    if (share_from != kByRule) {
      sharing.least_cells = share_from;
      sharing.least_one_in = 0;
    }
    sharing.threads = threads_each;
    if (shows_traffic) sharing.tell_figures = hfr::app::print_figures;
    return sharing;
  }
};

void add_own_options(hfr::app::Command command, OwnOptions& own) {
  command.example("mpirun -n 4 hfremesh-mpi bad.mesh -o good.mesh --min-dihedral 15",
                  "on four ranks, with the output of one");
  command.example("mpirun -n 4 hfremesh-mpi parts --help", "meshes that no rank holds alone");
  command.group("Several ranks");
  command
      .option("--share-from", own.share_from,
              "Passes with fewer cells to look at are done by one rank; unless given, with fewer than 1000, "
              "or than "
              "one in 32 of all. The output is the same for each number")
      .type_name("N")
      .check(hfr::app::whole_number());
  command
      .option("--threads-each", own.threads_each,
              "Threads of each rank in the passes that all ranks do; --threads are those of the first rank "
              "while the others wait, and unless given as many as there are ranks on its machine")
      .type_name("N")
      .shows_default()
      .check(hfr::app::whole_number(1, 1024));
  command.option("--partition", own.partition, "How the mesh is cut; graph is PT-Scotch")
      .type_name("HOW")
      .shows_default()
      .one_of({"coordinates", "graph", "numbers"})
      .check([](const std::string& how) {
        const bool lacks = how == "graph" && !hfr::mpi::has_graph_partition();
        return lacks ? std::string("this build has no PT-Scotch; coordinates and numbers are there") : "";
      });
  command.flag("--traffic", own.shows_traffic,
               "Print what ranks have sent, their memory, and seconds by phase");
}

/// Rank 0. What another rank throws becomes an error of the tool, with the exit code that it has there.
int lead(int argc, char** argv, hfr::mpi::Comm& comm, int cores) {
  OwnOptions own;
  bool are_gone = false, has_thrown = false;
  hfr::app::Variant variant;
  variant.name = "hfremesh-mpi";
  if (comm.size() > 1) variant.threads = cores;
  variant.add_options = [&](hfr::app::Command& command) { add_own_options(command, own); };
  variant.improve = [&](hfr::TetMesh& mesh, const hfr::ImproveOptions& options) {
    try {
      return hfr::mpi::improve(mesh, options, comm, own.sharing());
    } catch (const hfr::mpi::RankFailed& failed) {
      are_gone = true;
      throw hfr::app::Failure(static_cast<ExitCode>(failed.code()), failed.what());
    } catch (...) {
      has_thrown = true;  // others may be in the midst of a pass
      throw;
    }
  };
  const int code = static_cast<int>(hfr::app::run_tool(argc, argv, variant));
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
  hfr::app::wait_passively(argv);
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &level);
  int code = 0;
  {
    hfr::mpi::Comm comm(MPI_COMM_WORLD);
    const int cores = hfr::mpi::lend_cores(comm);
    if (hfr::app::is_in_parts(argc, argv))
      code = hfr::app::run_in_parts(argc, argv, comm);
    else
      code = comm.rank() == 0 ? lead(argc, argv, comm, cores) : follow(comm);
  }
  MPI_Finalize();
  return code;
}

// SPDX-License-Identifier: BSD-3-Clause
#include <mpi.h>

#include <cstdio>
#include <hfremesh/Distributed/Buffer.hh>
#include <hfremesh/Distributed/Comm.hh>
#include <hfremesh/Distributed/Improve.hh>
#include <hfremesh/Distributed/Order.hh>
#include <hfremesh/Distributed/Partition.hh>
#include <hfremesh/Distributed/RankArrays.hh>
#include <hfremesh/HalfFace/Generate.hh>

#if __has_include(<Distributed/Improve.hh>)
#error "folders of hfremesh lie in the include path of its users"
#endif

/// The cavity with 48 inverted cells, improved by all ranks: nothing inverted is left, and it has the points
/// of one rank.
int lead(hfr::mpi::Comm& comm) {
  const hfr::generate::Arrays arrays = hfr::generate::cavity();
  hfr::TetMesh together = hfr::build(arrays.points, arrays.cells), alone = together;
  hfr::ImproveOptions options;
  options.min_dihedral = 15;
  const hfr::Result result = hfr::mpi::improve(together, options, comm, {hfr::mpi::Partition::kGraph, 0});
  hfr::mpi::dismiss(comm);
  hfr::improve(alone, options);
  bool same = together.n_vertices() == alone.n_vertices() && together.n_cells() == alone.n_cells();
  for (hfr::Index v = 0; same && v < alone.n_vertices(); ++v)
    same = together.points()[v] == alone.points()[v];
  std::printf("hfremesh %s on %d ranks%s: %zu inverted before, %zu invalid after, %s\n", HFR_VERSION,
              comm.size(), hfr::mpi::has_graph_partition() ? " cut by PT-Scotch" : "",
              result.before.inverted.size(), result.invalid_cells.size(),
              same ? "as on one" : "not as on one");
  return same && result.changed && result.invalid_cells.empty() ? 0 : 1;
}

int main(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  int code = 0;
  {
    hfr::mpi::Comm comm(MPI_COMM_WORLD);
    code = comm.rank() == 0 ? lead(comm) : hfr::mpi::serve(comm);
  }
  MPI_Finalize();
  return code;
}

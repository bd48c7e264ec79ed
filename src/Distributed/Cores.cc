// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Cores.hh"

#ifdef __linux__
#include <sched.h>
#endif

#include <algorithm>

#include "Parallel/Parallel.hh"

namespace hfr::mpi {
namespace {

/// The ranks of one machine, each with its number in the whole as its key: so rank 0 is the first of its own.
class Machine {
 public:
  explicit Machine(const Comm& comm) {
    MPI_Comm_split_type(comm.handle(), MPI_COMM_TYPE_SHARED, comm.rank(), MPI_INFO_NULL, &comm_);
    MPI_Comm_size(comm_, &n_ranks_);
  }
  ~Machine() { MPI_Comm_free(&comm_); }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  MPI_Comm handle() const { return comm_; }
  int n_ranks() const { return n_ranks_; }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  int n_ranks_ = 1;
};

#ifdef __linux__
/// Cores that any rank of the machine may use; the first of them is let use all. 0: unknown.
int unite_cores(const Machine& machine, bool is_first) {
  cpu_set_t mine;
  CPU_ZERO(&mine);
  if (sched_getaffinity(0, sizeof(mine), &mine) != 0) CPU_ZERO(&mine);
  cpu_set_t all = mine;
  MPI_Allreduce(&mine, &all, static_cast<int>(sizeof(mine)), MPI_BYTE, MPI_BOR, machine.handle());
  if (!is_first) return 1;
  if (CPU_COUNT(&mine) == 0 || sched_setaffinity(0, sizeof(all), &all) != 0) return CPU_COUNT(&mine);
  return CPU_COUNT(&all);
}
#else
int unite_cores(const Machine&, bool) { return par::Policy::all().threads; }
#endif

}  // namespace

int lend_cores(const Comm& comm) {
  const Machine machine(comm);
  const bool is_first = comm.rank() == 0;
  const int n_cores = unite_cores(machine, is_first);
  return is_first ? std::max(1, std::min(machine.n_ranks(), n_cores)) : 1;
}

}  // namespace hfr::mpi

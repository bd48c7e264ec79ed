// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_REMESH_DRIVERS_HH
#define HFR_UNITTESTS_REMESH_DRIVERS_HH

#include <ostream>
#include <string>
#include <vector>

#include "hfremesh/HalfFace/Config.hh"
#include "hfremesh/Remesh/Improve.hh"

namespace hfr::test {

/// One of the ways that a run of improve() can take.
struct Driver {
  std::string name;
  ImproveOptions options;
  friend std::ostream& operator<<(std::ostream& out, const Driver& driver) { return out << driver.name; }
};

class DriverList {
 public:
  ImproveOptions& add(const char* name) {
    all_.push_back({name, {}});
    all_.back().options.statistics = false;
    return all_.back().options;
  }
  std::vector<Driver> take() { return std::move(all_); }

 private:
  std::vector<Driver> all_;
};

/// One driver for each order of stages and each mode of the surface.
inline std::vector<Driver> courses() {
  DriverList list;
  list.add("default");
  list.add("goal").min_dihedral = 20;
  ImproveOptions& most = list.add("max");
  most.raise_min_dihedral = true;
  most.iterations = 2;
  list.add("coarsen").coarsen = true;
  list.add("kinds in turn").rounds = Rounds::kByKind;
  list.add("paper").compat = Compat::kJpdc2013;
  ImproveOptions& cluster = list.add("cluster search");
  cluster.ops = Ops::kDefault | Ops::kCluster;
  cluster.min_dihedral = 30;
#ifdef HFR_SURFACE
  list.add("flat").surface.mode = SurfaceMode::kFlat;
  ImproveOptions& flat_goal = list.add("flat with a goal");
  flat_goal.surface.mode = SurfaceMode::kFlat;
  flat_goal.min_dihedral = 30;
  list.add("free").surface.mode = SurfaceMode::kFree;
  ImproveOptions& free_coarse = list.add("free, coarsen");
  free_coarse.surface.mode = SurfaceMode::kFree;
  free_coarse.coarsen = true;
#endif
  return list.take();
}

/// The same stages with other operators, metrics or goals.
inline std::vector<Driver> variations() {
  DriverList list;
  list.add("high goal").min_dihedral = 45;
  list.add("bulk nodes").bulk_nodes = true;
  ImproveOptions& inserting = list.add("paper with insertion");
  inserting.compat = Compat::kJpdc2013;
  inserting.ops = Ops::kDefault | Ops::kInsert;
  list.add("kinds mixed").rounds = Rounds::kMixed;
  list.add("candidates").smoother = Smoother::kCandidates;
  list.add("Laplacian").smoother = Smoother::kLaplacian;
  list.add("Taubin").smoother = Smoother::kTaubin;
  list.add("radius ratio").metric = Metric::kRadiusRatio;
#ifdef HFR_SURFACE
  ImproveOptions& free_goal = list.add("free with a goal");
  free_goal.surface.mode = SurfaceMode::kFree;
  free_goal.min_dihedral = 25;
#endif
  return list.take();
}

}  // namespace hfr::test

#endif

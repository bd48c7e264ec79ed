// SPDX-License-Identifier: BSD-3-Clause
#include "hfremesh/Quality/Statistics.hh"

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <optional>
#include <tuple>

#include "Arrays.hh"
#include "Mesh.hh"
#include "hfremesh/Quality/CellQuality.hh"
#include "hfremesh/Quality/FoldedFaces.hh"

namespace hfr::python {
namespace {

using namespace nb::literals;

std::array<double, 3> xyz(Vec3 p) { return {p.x, p.y, p.z}; }

/// Degrees, the two vertices of the edge, and a cell there; nothing where there is no such edge.
std::optional<std::tuple<double, std::array<std::int64_t, 2>, std::int64_t>> wedge_of(
    const EdgeWedge& wedge) {
  if (!wedge.a.is_valid()) return std::nullopt;
  return std::make_tuple(wedge.degrees, std::array<std::int64_t, 2>{wedge.a.idx(), wedge.b.idx()},
                         std::int64_t{wedge.cell.idx()});
}

void bind_distribution(nb::module_& module) {
  nb::class_<Distribution>(module, "Distribution",
                           "One value a cell: its least, mean, largest and percentiles.")
      .def_ro("min", &Distribution::min)
      .def_ro("mean", &Distribution::mean)
      .def_ro("max", &Distribution::max)
      .def_prop_ro(
          "percentiles",
          [](const Distribution& d) {
            std::map<double, double> by_percentage;
            for (std::size_t i = 0; i < kPercentiles.size(); ++i)
              by_percentage[kPercentiles[i]] = d.percentiles[i];
            return by_percentage;
          },
          "{percentage: value} for 0.1, 1, 5, 25, 50, 75, 95, 99 and 100; nearest rank.")
      .def("__repr__", [](const Distribution& d) {
        return "<hfremesh.Distribution: " + std::to_string(d.min) + " to " + std::to_string(d.max) +
               ", mean " + std::to_string(d.mean) + ">";
      });
}

void bind_counts(nb::class_<Statistics>& type) {
  type.def_ro("vertices", &Statistics::vertices)
      .def_ro("unused_vertices", &Statistics::unused_vertices, "Vertices without a cell.")
      .def_ro("cells", &Statistics::cells)
      .def_ro("edges", &Statistics::edges)
      .def_ro("faces", &Statistics::faces)
      .def_ro("boundary_faces", &Statistics::boundary_faces)
      .def_ro("interface_faces", &Statistics::interface_faces, "Faces between cells of two regions.")
      .def_ro("components", &Statistics::components, "Sets of cells that connect through faces.")
      .def_prop_ro(
          "inverted", [](const Statistics& s) { return s.inverted.size(); },
          "Number of cells of negative volume, beyond rounding.")
      .def_prop_ro(
          "inverted_cells", [](const Statistics& s) { return handle_array(s.inverted); },
          "(k,) int64, ascending.", kOwned)
      .def_prop_ro(
          "flat", [](const Statistics& s) { return s.flat.size(); },
          "Number of cells whose volume hides in rounding.")
      .def_prop_ro(
          "flat_cells", [](const Statistics& s) { return handle_array(s.flat); }, "(k,) int64, ascending.",
          kOwned)
      .def_prop_ro(
          "worst_cell",
          [](const Statistics& s) {
            return s.worst_cell.is_valid() ? std::optional<std::int64_t>(s.worst_cell.idx()) : std::nullopt;
          },
          "The first cell with the smallest dihedral of all; None without cells.");
}

void bind_figures(nb::class_<Statistics>& type) {
  type.def_prop_ro(
          "min_dihedral", [](const Statistics& s) { return s.min_dihedral.min; },
          "Smallest dihedral angle, degrees; negative in an inverted cell.")
      .def_ro("max_dihedral", &Statistics::max_dihedral, "Degrees; inverted cells left out.")
      .def_ro("mean_dihedral", &Statistics::mean_dihedral, "Degrees, of all six of all cells.")
      .def_ro("min_dihedrals", &Statistics::min_dihedral, "Distribution of each cell's smallest, degrees.")
      .def_ro("volume_length", &Statistics::volume_length,
              "Distribution of q = 6 sqrt(2) V / l_rms^3: 1 regular, 0 flat, below 0 inverted.")
      .def_ro("edge_length", &Statistics::edge_length, "Distribution over the six edges of every cell.")
      .def_prop_ro(
          "dihedral_histogram",
          [](const Statistics& s) {
            return to_array(
                std::vector<std::uint64_t>(s.dihedral_histogram.begin(), s.dihedral_histogram.end()));
          },
          "(36,) uint64: all six dihedrals of all cells, bins of 5 degrees; inverted cells left out.", kOwned)
      .def_prop_ro(
          "volume_length_histogram",
          [](const Statistics& s) {
            return to_array(std::vector<std::uint64_t>(s.volume_length_histogram.begin(),
                                                       s.volume_length_histogram.end()));
          },
          "(20,) uint64: q from 0 to 1; inverted cells left out.", kOwned)
      .def_prop_ro(
          "box", [](const Statistics& s) { return std::make_tuple(xyz(s.box_low), xyz(s.box_high)); },
          "Lower and upper corner of the bounding box.")
      .def_ro("volume", &Statistics::volume, "Sum of signed volumes.")
      .def_ro("absolute_volume", &Statistics::absolute_volume)
      .def_ro("enclosed_volume", &Statistics::enclosed_volume, "Enclosed by the boundary faces.")
      .def_ro("overlap", &Statistics::overlap,
              "absolute_volume / |enclosed_volume| - 1; 0 where nothing overlaps.")
      .def_ro("regions", &Statistics::regions, "One RegionStatistics a region, ascending.")
      .def_ro("patches", &Statistics::patches,
              "One PatchStatistics a label of faces, ascending; 0: boundary faces without one.")
      .def_prop_ro(
          "surface_ceiling", [](const Statistics& s) { return wedge_of(s.surface_ceiling); },
          "(degrees, (a, b), cell) of the narrowest wedge of the boundary: no cell there can have a "
          "larger dihedral while the surface is frozen. None without one.")
      .def_prop_ro(
          "interface_ceiling", [](const Statistics& s) { return wedge_of(s.interface_ceiling); },
          "The same with interfaces and labelled faces frozen, too.")
      .def_prop_ro(
          "angle_ceiling", [](const Statistics& s) { return wedge_of(s.angle_ceiling); },
          "(degrees, (a, b), cell): what the smallest dihedral of all can be at most, proven, while these "
          "faces stay. None where nothing is proven.");
}

Statistics statistics_of(const Mesh& mesh, int threads) {
  require_finite(mesh.tets.points().data(), mesh.tets.n_vertices(), "points");
  const par::Policy policy = policy_of(threads);
  nb::gil_scoped_release others_run;
  return statistics(mesh.tets, policy);
}

Array<double> qualities(const Mesh& mesh, const std::string& name, int threads) {
  const Metric metric = metric_from_name(name);
  const par::Policy policy = policy_of(threads);
  std::vector<double> values(mesh.tets.n_cells());
  {
    nb::gil_scoped_release others_run;
    par::for_each(policy, values.size(),
                  [&](std::size_t c) { values[c] = quality(mesh.tets, CellHandle(c), metric); });
  }
  return to_array(std::move(values));
}

}  // namespace

void bind_statistics(nb::module_& module) {
  bind_distribution(module);
  nb::class_<RegionStatistics>(module, "RegionStatistics", "The cells of one region.")
      .def_ro("region", &RegionStatistics::region)
      .def_ro("cells", &RegionStatistics::cells)
      .def_ro("inverted", &RegionStatistics::inverted)
      .def_ro("flat", &RegionStatistics::flat)
      .def_ro("volume", &RegionStatistics::volume, "Signed.")
      .def_ro("min_dihedral", &RegionStatistics::min_dihedral, "Degrees.");
  nb::class_<PatchStatistics>(module, "PatchStatistics", "The faces of one label.")
      .def_ro("label", &PatchStatistics::label)
      .def_ro("faces", &PatchStatistics::faces)
      .def_ro("area", &PatchStatistics::area);
  nb::class_<Statistics> type(module, "Statistics", "Figures of a mesh; angles in degrees.");
  bind_counts(type);
  bind_figures(type);
  type.def("__repr__", [](const Statistics& s) {
    return "<hfremesh.Statistics: " + std::to_string(s.cells) + " cells, " +
           std::to_string(s.inverted.size()) + " inverted, " + std::to_string(s.flat.size()) +
           " flat, smallest dihedral " + std::to_string(s.min_dihedral.min) + ">";
  });
  module.def("statistics", &statistics_of, "mesh"_a, "threads"_a = 0, "Figures of the mesh.");
  module.def("quality", &qualities, "mesh"_a, "metric"_a, "threads"_a = 0,
             "(m,) float64: a metric's value for each cell, as the literature prints it.");
  module.def(
      "folded_faces",
      [](const Mesh& m, int threads) {
        const par::Policy policy = policy_of(threads);
        std::vector<std::array<VertexHandle, 3>> faces;
        {
          nb::gil_scoped_release others_run;
          for (HalfFaceHandle h : folded_faces(m.tets, policy)) faces.push_back(m.tets.halfface_vertices(h));
        }
        return tuple_array(faces);
      },
      "mesh"_a, "threads"_a = 0, "(k, 3) int64: boundary faces that lie on or go through one another.");
  std::vector<std::string> names;
  for (Metric metric : kMetrics) names.emplace_back(metric_name(metric));
  module.attr("METRICS") = nb::tuple(nb::cast(names));
}

}  // namespace hfr::python

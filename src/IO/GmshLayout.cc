// SPDX-License-Identifier: BSD-3-Clause
// Which entities and blocks the elements make, whatever process has them.
#include <algorithm>
#include <set>

#include "IO/GmshElements.hh"
#include "IO/WriteGmsh.hh"

namespace hfr::io::gmsh {
namespace {

/// What the other processes have to know of the runs of one.
struct Ends {
  std::uint64_t count = 0, n_runs = 0, first_length = 0;
  int first_label = 0, last_label = 0;
};
using AllEnds = std::vector<std::array<Ends, 4>>;  // of each process, by dimension

/// One label and its box.
struct BoxRecord {
  int dimension = 0, label = 0;
  LabelBox box;
};

std::vector<int> labels_of(const ElementStretch& elements) {
  std::vector<int> labels(elements.labels.begin(), elements.labels.end());
  labels.resize(elements.corners.size(), 0);
  return labels;
}

/// One group a label, in the order of labels. Entities take their label as a tag where it is positive, and
/// the smallest free tag otherwise.
std::vector<Group> groups_of(const std::set<int>& labels) {
  std::vector<Group> groups;
  int free = 1;
  for (const int label : labels) {
    while (label <= 0 && labels.count(free) > 0) ++free;
    groups.push_back({label, label > 0 ? label : free++});
  }
  return groups;
}

/// The labels of all processes, by dimension.
std::array<std::set<int>, 4> all_labels(const std::array<std::vector<int>, 4>& mine,
                                        const Processes& processes) {
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t d = 0; d < 4; ++d)
    for (const int label : std::set<int>(mine[d].begin(), mine[d].end()))
      pairs.emplace_back(static_cast<int>(d), label);
  std::vector<std::array<int, 2>> said;
  for (const auto& [d, label] : pairs) said.push_back({d, label});
  std::array<std::set<int>, 4> all;
  for (const auto& [d, label] : processes.gather(std::span<const std::array<int, 2>>(said)))
    all[static_cast<std::size_t>(d)].insert(label);
  return all;
}

std::vector<Run> runs_of(const std::vector<int>& labels, const std::vector<Group>& groups) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (i == 0 || labels[i] != labels[i - 1]) {
      const auto group =
          std::partition_point(groups.begin(), groups.end(), [&](Group g) { return g.label < labels[i]; });
      runs.push_back({static_cast<std::size_t>(group - groups.begin()), i, i, 0});
    }
    runs.back().end = i + 1;
    runs.back().length = runs.back().end - runs.back().begin;
  }
  return runs;
}

/// Joins the runs of process `rank` with those of the others that go on with the same label.
void join(Dimension& elements, const AllEnds& all, std::size_t d, std::size_t rank) {
  const Ends* last = nullptr;  // of the processes so far that have elements
  for (std::size_t p = 0; p < all.size(); ++p) {
    const Ends& ends = all[p][d];
    elements.count += ends.count;
    if (p < rank) elements.first_tag += ends.count;
    if (ends.count == 0) continue;
    elements.n_runs += ends.n_runs;
    if (last && last->last_label == ends.first_label) {
      --elements.n_runs;
      if (p == rank) elements.runs.front().length = 0;
    }
    last = &ends;
  }
  if (elements.runs.empty() || elements.runs.back().length == 0) return;
  for (std::size_t p = rank + 1; p < all.size(); ++p) {
    const Ends& ends = all[p][d];
    if (ends.count == 0) continue;
    if (ends.first_label != all[rank][d].last_label) break;
    elements.runs.back().length += ends.first_length;
    if (ends.n_runs > 1) break;
  }
}

void gather_boxes(const MeshStretch& mesh, Layout& layout) {
  std::vector<BoxRecord> mine;
  for (const auto& [key, box] : mesh.boxes.all()) mine.push_back({key.first, key.second, box});
  LabelBoxes all;
  for (const BoxRecord& r : mesh.processes.gather(std::span<const BoxRecord>(mine)))
    all.add(r.dimension, r.label, std::array{r.box.low, r.box.high});
  layout.boxes = all.all();
}

}  // namespace

void lay_out(const MeshStretch& mesh, Layout& layout) {
  std::array<std::vector<int>, 4> labels = {
      {{}, labels_of(mesh.edges), labels_of(mesh.triangles), labels_of(mesh.cells)}};
  for (std::size_t i = 0; i < mesh.vertex_labels.size(); ++i) {
    if (mesh.vertex_labels[i] == 0) continue;
    labels[0].push_back(mesh.vertex_labels[i]);
    layout.labelled_points.push_back(mesh.first_point + i);
  }
  const std::array<NumberRows, 4> nodes = {NumberRows(layout.labelled_points), mesh.edges.corners,
                                           mesh.triangles.corners, mesh.cells.corners};
  constexpr std::array<int, 4> kTypes = {kPoint, kLine2, kTriangle3, kTetrahedron4};
  const std::array<std::set<int>, 4> distinct = all_labels(labels, mesh.processes);
  std::array<Ends, 4> ends;
  for (std::size_t d = 0; d < 4; ++d) {
    Dimension& elements = layout.dimensions[d];
    elements.type = kTypes[d];
    elements.nodes = nodes[d];
    elements.groups = groups_of(distinct[d]);
    elements.runs = runs_of(labels[d], elements.groups);
    if (labels[d].empty()) continue;
    ends[d] = {labels[d].size(), elements.runs.size(), elements.runs.front().length, labels[d].front(),
               labels[d].back()};
  }
  const AllEnds all = mesh.processes.gather(std::span<const std::array<Ends, 4>>(&ends, 1));
  std::uint64_t tag = 1;
  for (std::size_t d = 0; d < 4; ++d) {
    Dimension& elements = layout.dimensions[d];
    elements.first_tag = tag;
    join(elements, all, d, mesh.processes.rank);
    tag += elements.count;
    for (const Group group : elements.groups) layout.has_labels |= group.label != 0;
  }
  gather_boxes(mesh, layout);
  // Nodes need an entity to belong to.
  if (layout.n_elements() == 0) layout.dimensions[3].groups.emplace_back();
}

}  // namespace hfr::io::gmsh

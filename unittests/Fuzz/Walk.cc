// SPDX-License-Identifier: BSD-3-Clause
#include "Fuzz/Walk.hh"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "Fuzz/RandomComplex.hh"
#include "HalfFace/Check.hh"
#include "HalfFace/Oracle.hh"
#include "HalfFace/Reorder.hh"
#include "IO/Hash.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/Replace.hh"
#include "Operators/VertexCollapse.hh"
#include "Quality/Metrics.hh"

namespace hfr::fuzz {
namespace {

constexpr std::size_t kMostCells = 250;  // beyond it cells are rather deleted than made

constexpr std::array<std::string_view, kOperations> kNames = {
    "add vertex",         "add cell",        "delete cell",   "delete vertex", "split edge",
    "split face",         "split cell",      "collapse edge", "face swap",     "edge removal",
    "multi-face removal", "vertex collapse", "swap vertices", "swap cells",    "move vertex",
    "collect garbage",    "reorder",         "labels",        "properties",    "restore"};

constexpr CheckOptions kKernelRules = {.last = Rule::kDuplicateEdge};

std::vector<double> qualities_of(const TetMesh& mesh) {
  std::vector<double> all(mesh.n_cells(), 1);
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    all[c.idx()] = VolumeLength{}(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
  }
  return all;
}

}  // namespace

std::string_view operation_name(Operation operation) { return kNames[static_cast<std::size_t>(operation)]; }

Walk::Walk(std::uint64_t number) : random_(number ^ 0x77616c6b00000000ULL) {
  Complex complex = random_complex(number);
  if (complex.cells.size() > kMostCells) {
    complex.cells.resize(kMostCells);
    if (!complex.regions.empty()) complex.regions.resize(kMostCells);
    complex.faces.clear();  // they may be of cells that are gone
    complex.edges.clear();
  }
  try {
    mesh_ = mesh_of(complex);
  } catch (const InvalidInput&) {
    return;
  }
  auto id = mesh_.request_vertex_property<int>("id", -1);
  auto region = mesh_.request_cell_property<int>("region again", 0);
  for (CellHandle c : mesh_.cells()) region[c] = mesh_.region(c);
  for (VertexHandle v : mesh_.vertices()) id[v] = -1, learn(v);
}

/// A vertex that is new, or that the walk has changed on purpose.
void Walk::learn(VertexHandle v) {
  auto id = mesh_.request_vertex_property<int>("id", -1);
  if (id[v] < 0) id[v] = next_id_++;
  known_[id[v]] = {mesh_.point(v), mesh_.is_fixed(v), mesh_.labels().vertex(v)};
}

void Walk::forget_deleted() {
  const auto id = mesh_.request_vertex_property<int>("id", -1);
  std::set<int> alive;
  for (VertexHandle v : mesh_.vertices()) alive.insert(id[v]);
  std::erase_if(known_, [&](const auto& entry) { return !alive.contains(entry.first); });
}

VertexHandle Walk::a_vertex() {
  for (std::size_t tries = 0; tries < 64; ++tries) {
    const VertexHandle v(random_.below(mesh_.n_vertices()));
    if (mesh_.exists(v)) return v;
  }
  return {};
}

CellHandle Walk::a_cell() {
  for (std::size_t tries = 0; tries < 64; ++tries) {
    const CellHandle c(random_.below(mesh_.n_cells()));
    if (mesh_.exists(c)) return c;
  }
  return {};
}

/// Is the cell, or one that has a vertex of it, at a pinched vertex? A run of the library keeps as far from
/// these.
bool Walk::touches_pinched(CellHandle c, const std::vector<std::uint8_t>& pinched) const {
  if (pinched.empty()) return false;
  for (VertexHandle v : mesh_.cell(c).v) {
    if (pinched[v.idx()] != 0) return true;
    for (VertexHandle w : mesh_.vertex_vertices(v))
      if (pinched[w.idx()] != 0) return true;
  }
  return false;
}

/// Onto an open face, with a new vertex or one that is there. What breaks a rule that add_cell() does not
/// look at (a second ring round an edge) is taken back.
bool Walk::add_cell() {
  const CellHandle on = a_cell();
  if (!on.is_valid()) return false;
  const HalfFaceHandle h = mesh_.cell_halffaces(on)[random_.below(4)];
  const auto f = mesh_.halfface_vertices(h);
  const VertexHandle apex =
      random_.chance(0.5) ? mesh_.add_vertex(mesh_.point(f[0]) + random_.step(1)) : a_vertex();
  if (auto id = mesh_.request_vertex_property<int>("id", -1); apex.is_valid() && id[apex] < 0) learn(apex);
  const bool right_way = random_.chance(0.9);
  const std::uint64_t before = io::mesh_hash(mesh_);
  try {
    const CellHandle made = mesh_.add_cell(f[0], right_way ? f[2] : f[1], right_way ? f[1] : f[2], apex);
    mesh_.set_region(made, random_.from_to(0, 2));
    mesh_.request_cell_property<int>("region again", 0)[made] = mesh_.region(made);
    if (check(mesh_, kKernelRules) == Rule::kDuplicateEdge) {
      mesh_.delete_cell(made);
      return false;
    }
    return true;
  } catch (const InvalidInput&) {
    if (io::mesh_hash(mesh_) != before) complaint_ = "a refused cell has changed the mesh";
    return false;
  }
}

bool Walk::collapse() {
  const CellHandle c = a_cell();
  if (!c.is_valid()) return false;
  const HalfEdgeHandle e = mesh_.cell_halfedges(c)[random_.below(12)];
  const VertexHandle from = mesh_.from_vertex(e), to = mesh_.to_vertex(e);
  const bool fine = mesh_.is_collapse_ok(e);
  const bool constrained = mesh_.is_fixed(from) || mesh_.labels().vertex(from) != 0;
  keeps_volume_ = fine && !mesh_.is_boundary(from);
  const std::uint64_t before = fine ? 0 : io::mesh_hash(mesh_);
  const VertexHandle left = mesh_.collapse_edge(e);
  if (left.is_valid() != fine) complaint_ = "is_collapse_ok() and collapse_edge() disagree";
  if (!fine && io::mesh_hash(mesh_) != before) complaint_ = "a refused collapse has changed the mesh";
  if (fine && (left != to || mesh_.exists(from))) complaint_ = "another vertex than the end is left";
  if (fine && constrained) complaint_ = "a fixed or labelled vertex is gone";
  return fine;
}

bool Walk::swap_or_remove(Operation operation) {
  constexpr int kTries = 24;  // most seeds have nothing to win
  const std::vector<double> quality = qualities_of(mesh_);
  const auto frozen = frozen_vertices(mesh_);
  const auto pinched = pinched_vertices(mesh_, star_sizes(mesh_));
  for (int i = 0; i < kTries && !keeps_volume_; ++i) {
    const CellHandle c = a_cell();
    if (!c.is_valid() || touches_pinched(c, pinched)) continue;
    const std::size_t k = random_.below(4);
    const HalfFaceHandle h = mesh_.cell_halffaces(c)[k];
    using Multi = MultiFaceRemoval<VolumeLength>;
    if (operation == Operation::kFaceSwap) {
      keeps_volume_ = hfr::apply(FaceSwap<VolumeLength>{{}, quality}, mesh_, h);
    } else if (operation == Operation::kEdgeRemoval) {
      const EdgeHandle e = mesh_.cell_edges(c)[random_.below(6)];
      keeps_volume_ = hfr::apply(EdgeRemoval<VolumeLength>{{}, quality}, mesh_, e);
    } else if (operation == Operation::kMultiFaceRemoval) {
      keeps_volume_ = hfr::apply(Multi{{}, quality}, mesh_, Multi::Seed(h));
    } else {
      const VertexHandle v = mesh_.cell(c).v[k];
      const bool constrained = mesh_.is_fixed(v) || mesh_.labels().vertex(v) != 0;
      keeps_volume_ = hfr::apply(VertexCollapse<VolumeLength>{{}, quality, frozen}, mesh_, v);
      if (keeps_volume_ && constrained) complaint_ = "a fixed or labelled vertex is gone";
    }
  }
  return keeps_volume_;
}

bool Walk::change_labels() {
  const CellHandle c = a_cell();
  const VertexHandle v = a_vertex();
  if (!c.is_valid()) return false;
  const int label = random_.from_to(0, 3);
  const bool on = random_.chance(0.5);
  switch (random_.below(6)) {
    case 0:
      mesh_.labels().faces.set(mesh_.halfface_vertices(mesh_.cell_halffaces(c)[random_.below(4)]), label);
      break;
    case 1:
      mesh_.labels().edges.set(mesh_.edge_vertices(mesh_.cell_edges(c)[random_.below(6)]), label);
      break;
    case 2:
      mesh_.labels().vertices.resize(mesh_.n_vertices(), 0);
      mesh_.labels().vertices[v.idx()] = label;
      learn(v);
      break;
    case 3:
      mesh_.set_fixed(v, on);
      learn(v);
      break;
    case 4:
      mesh_.set_fixed(mesh_.cell_edges(c)[random_.below(6)], on);
      break;
    default:
      mesh_.set_fixed(mesh_.cell_faces(c)[random_.below(4)], on);
  }
  return true;
}

/// Properties of each kind come, are set and read, and go.
bool Walk::change_properties() {
  const CellHandle c = a_cell();
  if (!c.is_valid()) return false;
  const std::string name = fmt::format("p{}", random_.below(3));
  const int value = random_.from_to(1, 100);
  const auto set_and_read = [&](auto property, auto handle) {
    if constexpr (requires { property.set(mesh_, handle, value); })
      property.set(mesh_, handle, value);
    else
      property[handle] = value;
    bool kept = false;
    if constexpr (requires { property.get(mesh_, handle); })
      kept = property.get(mesh_, handle) == value;
    else
      kept = property[handle] == value;
    if (!kept) complaint_ = "a property does not keep its value";
  };
  switch (random_.below(6)) {
    case 0:
      set_and_read(mesh_.request_edge_property<int>(name), mesh_.cell_edges(c)[random_.below(6)]);
      break;
    case 1:
      set_and_read(mesh_.request_face_property<int>(name), mesh_.cell_faces(c)[random_.below(4)]);
      break;
    case 2:
      set_and_read(mesh_.request_halfface_property<int>(name), mesh_.cell_halffaces(c)[random_.below(4)]);
      break;
    case 3:
      set_and_read(mesh_.request_vertex_property<int>(name), mesh_.cell(c).v[random_.below(4)]);
      break;
    case 4:
      set_and_read(mesh_.request_cell_property<int>(name), c);
      break;
    default:
      mesh_.properties().edges.remove(name);
      mesh_.properties().faces.remove(name);
      mesh_.properties().cells.remove(name);
  }
  return true;
}

bool Walk::renumber(Operation operation) {
  keeps_volume_ = true;
  if (operation == Operation::kCollectGarbage) {
    mesh_.collect_garbage({.drop_unused_vertices = random_.chance(0.5)});
    if (mesh_.n_cells() != mesh_.n_logical_cells()) complaint_ = "garbage is left";
  } else if (operation == Operation::kReorder) {
    reorder(mesh_, {.curve = random_.chance(0.5) ? SpaceCurve::kHilbert : SpaceCurve::kMorton,
                    .vertices = random_.chance(0.5)});
  } else if (operation == Operation::kSwapVertices) {
    const VertexHandle a = a_vertex(), b = a_vertex();
    if (!a.is_valid() || !b.is_valid()) return false;
    mesh_.swap_vertices(a, b);
  } else {
    const CellHandle a = a_cell(), b = a_cell();
    if (!a.is_valid() || !b.is_valid()) return false;
    mesh_.swap_cells(a, b);
  }
  return true;
}

/// True where the mesh has changed.
bool Walk::apply(Operation operation) {
  keeps_volume_ = false;
  const auto learn_new = [&](VertexHandle v) {
    mesh_.request_vertex_property<int>("id", -1)[v] = -1;  // that of its nearest neighbour until now
    learn(v);
    keeps_volume_ = true;
  };
  const CellHandle c = a_cell();
  const VertexHandle v = a_vertex();
  if (!c.is_valid() || !v.is_valid()) return false;
  switch (operation) {
    case Operation::kAddVertex:
      learn_new(mesh_.add_vertex(random_.step(2)));
      return true;
    case Operation::kAddCell:
      return add_cell();
    case Operation::kDeleteCell:
      mesh_.delete_cell(c);
      return true;
    case Operation::kDeleteVertex:
      mesh_.delete_vertex(v);
      return true;
    case Operation::kSplitEdge:
      learn_new(mesh_.split_edge(mesh_.cell_edges(c)[random_.below(6)]));
      return true;
    case Operation::kSplitFace:
      learn_new(mesh_.split_face(mesh_.cell_faces(c)[random_.below(4)]));
      return true;
    case Operation::kSplitCell:
      learn_new(mesh_.split_cell(c));
      return true;
    case Operation::kCollapseEdge:
      return collapse();
    case Operation::kMoveVertex:
      mesh_.set_point(v, mesh_.point(v) + random_.step(0.2));
      learn(v);
      return true;
    case Operation::kLabels:
      return change_labels();
    case Operation::kProperties:
      return change_properties();
    case Operation::kRestore: {
      const std::uint64_t before = io::mesh_hash(mesh_);
      TetMesh saved = mesh_;
      mesh_.delete_vertex(v);
      mesh_.collect_garbage();
      mesh_.restore(std::move(saved));
      keeps_volume_ = true;
      if (io::mesh_hash(mesh_) != before) complaint_ = "restore() gives another mesh";
      return true;
    }
    case Operation::kSwapVertices:
    case Operation::kSwapCells:
    case Operation::kCollectGarbage:
    case Operation::kReorder:
      return renumber(operation);
    default:
      return swap_or_remove(operation);
  }
}

long double Walk::volume() const {
  long double sum = 0;
  for (CellHandle c : mesh_.cells()) {
    const auto& v = mesh_.cell(c).v;
    const Vec3 p = mesh_.point(v[0]);
    sum += dot(cross(mesh_.point(v[1]) - p, mesh_.point(v[2]) - p), mesh_.point(v[3]) - p);
  }
  return sum;
}

/// Splits, swaps and collapses of inner vertices keep the sum of volumes to rounding, of which there is as
/// much as the largest coordinate has.
std::string Walk::wrong_volume(long double before) const {
  double largest = 0;
  for (VertexHandle v : mesh_.vertices())
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(mesh_.point(v)[k]));
  if (!keeps_volume_ || largest > 1e90) return "";
  const long double allowed =
      1e-12L * static_cast<long double>(mesh_.n_cells()) * largest * largest * largest;
  const long double now = volume();
  if (std::abs(now - before) <= allowed) return "";
  return fmt::format("six times the volume was {} and is {}", static_cast<double>(before),
                     static_cast<double>(now));
}

std::string Walk::wrong_data() const {
  const auto id = mesh_.get_vertex_property<int>("id");
  const auto region = mesh_.get_cell_property<int>("region again");
  if (!id || !region) return "a property is gone";
  std::size_t n = 0;
  for (VertexHandle v : mesh_.vertices()) {
    ++n;
    const auto at = known_.find((*id)[v]);
    if (at == known_.end()) return fmt::format("vertex {} has the number of none", v.idx());
    const Known& was = at->second;
    if (was.point != mesh_.point(v)) return fmt::format("vertex {} has moved", v.idx());
    if (was.fixed != mesh_.is_fixed(v)) return fmt::format("vertex {} is fixed or not", v.idx());
    if (was.label != mesh_.labels().vertex(v)) return fmt::format("vertex {} has another label", v.idx());
  }
  if (n != known_.size()) return fmt::format("{} vertices, {} known", n, known_.size());
  for (CellHandle c : mesh_.cells())
    if ((*region)[c] != mesh_.region(c))
      return fmt::format("cell {} has region {} and the property of {}", c.idx(), mesh_.region(c),
                         (*region)[c]);
  return "";
}

std::string Walk::step(WalkCounts& counts) {
  std::size_t kind = random_.below(kOperations);
  if (mesh_.n_logical_cells() > kMostCells && random_.chance(0.5))
    kind = static_cast<std::size_t>(Operation::kDeleteVertex);
  if (mesh_.n_logical_cells() < 12 && random_.chance(0.7))
    kind = static_cast<std::size_t>(random_.chance(0.5) ? Operation::kAddCell : Operation::kSplitEdge);
  const auto operation = static_cast<Operation>(kind);
  complaint_.clear();
  const long double before = volume();
  const bool changed = apply(operation);
  ++(changed ? counts.done : counts.refused)[kind];
  forget_deleted();
  std::string wrong = complaint_;
  // Pinched vertices and edges are part of the walk; the kernel's rules hold without exception.
  const CheckResult rule = check(mesh_);
  if (wrong.empty() && !rule && rule.rule != Rule::kNonManifoldEdge && rule.rule != Rule::kNonManifoldVertex)
    wrong = std::string(rule_name(rule.rule)) + ": " + rule.message;
  if (wrong.empty()) wrong = wrong_data();
  if (wrong.empty()) wrong = wrong_volume(before);
  return wrong.empty() ? "" : fmt::format("{}: {}", operation_name(operation), wrong);
}

std::string Walk::compare() const {
  const test::Oracle oracle(mesh_);
  if (oracle.cells().size() != mesh_.n_logical_cells()) return "number of cells";
  if (oracle.faces().size() != mesh_.n_faces()) return "number of faces";
  std::size_t n_fans = 0;
  for (const auto& [edge, cells] : oracle.edges()) n_fans += oracle.rings(edge).size();
  if (n_fans != mesh_.n_edges()) return "number of edges";
  std::size_t n_boundary = 0;
  for (const auto& [face, cells] : oracle.faces()) n_boundary += cells.size() == 1 ? 1 : 0;
  std::size_t n_said = 0;
  for (FaceHandle f : mesh_.boundary_faces()) n_said += mesh_.exists(f) ? 1 : 0;
  if (n_said != n_boundary) return "number of boundary faces";
  const auto sorted_key = [](auto key) {
    std::sort(key.begin(), key.end());
    return key;
  };
  for (const auto& entry : mesh_.labels().faces.entries())
    if (!oracle.faces().contains(sorted_key(entry.vertices))) return "a label on a face that is gone";
  for (const auto& entry : mesh_.labels().edges.entries())
    if (!oracle.edges().contains(sorted_key(entry.vertices))) return "a label on an edge that is gone";
  for (const auto& entry : mesh_.locks().faces.entries())
    if (!oracle.faces().contains(sorted_key(entry.vertices))) return "a lock on a face that is gone";
  for (const auto& entry : mesh_.locks().edges.entries())
    if (!oracle.edges().contains(sorted_key(entry.vertices))) return "a lock on an edge that is gone";
  return "";
}

}  // namespace hfr::fuzz

// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/Paranoid.hh"

#include <cxxabi.h>

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"

namespace hfr::detail {
namespace {

std::string readable(const std::type_info& type) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> name(
      abi::__cxa_demangle(type.name(), nullptr, nullptr, &status), std::free);
  return status == 0 ? name.get() : type.name();
}

/// "quality of cell 5 is 0.25, counted anew 0.5", with all digits.
template <class A, class B>
std::string differs(const char* what, std::size_t i, const A& kept, const B& counted) {
  std::ostringstream text;
  text.precision(17);
  text << what << " " << i << " is " << +kept << ", counted anew " << +counted;
  return text.str();
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_place(Vec3 a, Vec3 b) { return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z); }

}  // namespace

Paranoid::Paranoid(const TetMesh& mesh, const Workspace& work, const char* what, const std::type_info& op,
                   Quality quality)
    : mesh_(mesh), work_(work), what_(what), op_(op), quality_(std::move(quality)), before_(mesh) {
  // Rules that no input breaks: build() refuses such cells.
  const CheckResult found = check(mesh_, {.last = Rule::kDuplicateFace});
  if (!found) demand("before", std::string(rule_name(found.rule)) + ": " + found.message);
  demand("before", wrong_count());
}

void Paranoid::look_again() const {
  demand("after", broken_rule());
  demand("after", forgotten_change());
  demand("after", wrong_count());
}

void Paranoid::demand(const char* when, const std::string& complaint) const {
  if (complaint.empty()) return;
  throw InternalError("HFR_PARANOID: " + std::string(when) + " a " + what_ + " of " + readable(op_) + ": " +
                      complaint);
}

std::string Paranoid::broken_rule() const {
  CheckResult found = check(mesh_, {.last = Rule::kDuplicateEdge});
  if (!found) {
    const Rule earlier = check(before_, {.last = found.rule}).rule;
    if (earlier == Rule::kNone || earlier > found.rule)
      return std::string(rule_name(found.rule)) + ": " + found.message;
  }
  found = check_changes(mesh_, before_);
  return found ? "" : std::string(rule_name(found.rule)) + ": " + found.message;
}

/// Cells that are others than they were have to be looked at again by every operator, and their vertices to
/// know of it.
std::string Paranoid::forgotten_change() const {
  for (std::size_t i = 0; i < mesh_.n_cells(); ++i) {
    const CellHandle c(i);
    if (mesh_.is_deleted(c)) continue;
    const auto& v = mesh_.cell(c).v;
    bool same = i < before_.n_cells() && v == before_.cell(c).v;
    for (std::size_t k = 0; k < 4 && same; ++k) same = same_place(mesh_.point(v[k]), before_.point(v[k]));
    if (same) continue;
    if (i >= work_.pending.size() || work_.pending[i] != 0xff)
      return "cell " + std::to_string(i) + " has changed and is not pending";
    for (VertexHandle u : v)
      if (u.idx() >= work_.changed.size() || work_.changed[u.idx()] != work_.clock)
        return "cell " + std::to_string(i) + " has changed and its vertex " + std::to_string(u.idx()) +
               " does not know";
  }
  return {};
}

std::string Paranoid::wrong_count() const {
  const std::size_t n = mesh_.n_cells(), n_vertices = mesh_.n_vertices();
  if (work_.quality.size() != n || work_.claim.size() != n || work_.pending.size() != n)
    return "quality, claim or pending is not as long as the cells are many";
  if (work_.frozen.size() != n_vertices || work_.star_size.size() != n_vertices ||
      work_.changed.size() != n_vertices || (!work_.pinched.empty() && work_.pinched.size() != n_vertices))
    return "frozen, star_size, changed or pinched is not as long as the vertices are many";
  std::string complaint = wrong_cell();
  return complaint.empty() ? wrong_vertex() : complaint;
}

std::string Paranoid::wrong_cell() const {
  for (std::size_t i = 0; i < mesh_.n_cells(); ++i) {
    if (work_.claim[i] != kUnclaimed) return differs("claim of cell", i, work_.claim[i], kUnclaimed);
    double counted = std::numeric_limits<double>::infinity();
    if (!mesh_.is_deleted(CellHandle(i))) {
      const auto& v = mesh_.cell(CellHandle(i)).v;
      counted = quality_(mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), mesh_.point(v[3]));
    }
    if (!same_bits(work_.quality[i], counted))
      return differs("quality of cell", i, work_.quality[i], counted);
  }
  if (!work_.all_touched)
    for (const Index c : work_.touched)
      if (c >= mesh_.n_cells()) return "touched lists a cell slot that does not exist";
  return {};
}

/// A vertex that is pinched no longer may still be said to be, and one whose star has outgrown Star not to
/// be: what a round makes of them it need not find out.
std::string Paranoid::wrong_vertex() const {
  const std::vector<std::uint32_t> star_size = star_sizes(mesh_);
  const std::vector<std::uint8_t> frozen = constrained_vertices(mesh_);
  Star star;
  for (std::size_t i = 0; i < mesh_.n_vertices(); ++i) {
    if (work_.star_size[i] != star_size[i])
      return differs("star_size of vertex", i, work_.star_size[i], star_size[i]);
    if (work_.changed[i] > work_.clock) return differs("changed of vertex", i, work_.changed[i], work_.clock);
    if (star_size[i] == 0) continue;
    if (work_.frozen[i] != frozen[i]) return differs("frozen of vertex", i, work_.frozen[i], frozen[i]);
    const bool may_be_pinched = !work_.pinched.empty() && work_.pinched[i] != 0;
    if (!may_be_pinched && star_size[i] <= Star::kCapacity &&
        is_pinched(mesh_, VertexHandle(i), star_size[i], star))
      return differs("pinched of vertex", i, 0, 1);
  }
  return {};
}

}  // namespace hfr::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartPatchSearch.hh"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "Distributed/Buffer.hh"
#include "Distributed/Cutout.hh"
#include "Distributed/CutoutRound.hh"
#include "HalfFace/Errors.hh"
#include "HalfFace/Writer.hh"
#include "Remesh/Patch.hh"

namespace hfr::mpi {
namespace {

/// Of faces, in the whole: those that have come have theirs before others are gone.
struct LabelChanges {
  std::vector<DistributedMesh::LabelledFace> set;
  std::vector<LabelOrder::Face> gone;
};

/// Those of a cutout, which are to be changed in the parts as well.
class CutoutLabels : public FaceLabels {
 public:
  CutoutLabels(Cutout& cutout) : cutout_(cutout) {}
  void set(const std::array<VertexHandle, 3>& face, int label) override {
    cutout_.set_face_label(face, label);
    set_.push_back({face, label});
  }
  void erase(const std::array<VertexHandle, 3>& face) override {
    if (cutout_.erase_face_label(face)) gone_.push_back(face);
  }
  /// Once all vertices have numbers.
  LabelChanges changes() const {
    const auto named = [&](const std::array<VertexHandle, 3>& f) {
      return LabelOrder::Face{cutout_.number(f[0]), cutout_.number(f[1]), cutout_.number(f[2])};
    };
    LabelChanges changes;
    for (const auto& [face, label] : set_) changes.set.push_back({named(face), label});
    for (const auto& face : gone_) changes.gone.push_back(named(face));
    return changes;
  }

 private:
  Cutout& cutout_;
  std::vector<std::pair<std::array<VertexHandle, 3>, int>> set_;
  std::vector<std::array<VertexHandle, 3>> gone_;
};

/// The cutout as the place of a search, which all ranks have alike: each tries on some of the patches, and
/// rank 0 puts back. Its list of free slots is the end of the whole's.
class CutoutPatches : public PatchPlace {
 public:
  CutoutPatches(Cutout& cutout, const DistributedMesh& parts, std::span<const std::uint64_t> worst,
                const PartSurface* surface)
      : cutout_(cutout), parts_(parts), n_cells_(static_cast<std::size_t>(parts.n_cells())) {
    if (surface) surface_ = surface->seen_from(cutout);
    for (std::uint64_t number : worst) worst_.push_back(cutout.cell_at(number));
  }

  TetMesh& mesh() override { return cutout_.mesh(); }
  std::span<const CellHandle> worst() const override { return worst_; }
  std::span<const std::uint8_t> pinched() const override { return cutout_.work().pinched; }
  const SurfaceMesh* surface(const SurfaceMesh*) override { return surface_.get(); }
  std::size_t n_cells() const override { return n_cells_; }
  bool tries_on(std::size_t patch) const override {
    return patch % parts_.comm().n_ranks() == static_cast<std::size_t>(parts_.comm().rank());
  }
  bool share(std::span<PatchVerdict> verdicts) override;
  void put_back(const Patch& patch, const TetMesh& changed) override;

  /// Adds what all ranks have to know of it.
  void say(Packer& said);

 private:
  /// What of one patch the other ranks need.
  struct Change {
    std::vector<std::uint64_t> removed;
    std::vector<VertexHandle> vertices;  // what there was, and what has come
    std::vector<CellHandle> cells;
    LabelChanges labels;
  };

  void make_room(std::size_t n);
  void own_new_vertices(const Change& change);

  Cutout& cutout_;
  const DistributedMesh& parts_;
  std::shared_ptr<const SurfaceMesh> surface_;
  std::vector<CellHandle> worst_;
  std::size_t n_cells_;
  SlotChange slots_;
  std::vector<int> new_owner_;  // of the vertices that have come
  std::vector<Change> changes_;
};

/// Where a rank has tried, and found nothing, it says so as those do that have not tried.
bool CutoutPatches::share(std::span<PatchVerdict> verdicts) {
  struct Told {
    std::uint32_t patch = 0, best = 0, held_back = 0;
  };
  std::vector<Told> told;
  for (std::size_t i = 0; i < verdicts.size(); ++i)
    if (verdicts[i].best != PatchVerdict::kNone || verdicts[i].held_back)
      told.push_back({static_cast<std::uint32_t>(i), verdicts[i].best, verdicts[i].held_back ? 1U : 0U});
  for (const Told& one : parts_.comm().all_gather(std::span<const Told>(told)))
    verdicts[one.patch] = {one.best, one.held_back != 0};
  return parts_.comm().rank() == 0;
}

/// So many slots that are free, in the order in which the whole would hand them out.
void CutoutPatches::make_room(std::size_t n) {
  std::vector<CellHandle>& free = TetMesh::Writer(mesh()).free_cells();
  const std::span<const std::uint64_t> all = parts_.free_slots();
  std::vector<CellHandle> more;
  while (free.size() + more.size() < n)
    more.push_back(cutout_.add_slot(slots_.n_taken < all.size() ? all[all.size() - ++slots_.n_taken]
                                                                : parts_.n_slots() + slots_.n_fresh++));
  free.insert(free.begin(), more.rbegin(), more.rend());
}

void CutoutPatches::put_back(const Patch& patch, const TetMesh& changed) {
  TetMesh& mesh = cutout_.mesh();
  const std::size_t n_old = patch.cells().size(), n_new = changed.n_logical_cells();
  const std::size_t n_same = std::min(n_old, n_new), n_vertices = mesh.n_vertices();
  make_room(n_new - n_same);
  Change change;
  for (CellHandle c : patch.cells()) change.removed.push_back(cutout_.number(c));
  change.cells.assign(patch.cells().begin(), patch.cells().begin() + static_cast<std::ptrdiff_t>(n_same));
  const std::vector<CellHandle>& free = TetMesh::Writer(mesh).free_cells();
  change.cells.insert(change.cells.end(), free.end() - static_cast<std::ptrdiff_t>(n_new - n_same),
                      free.end());
  CutoutLabels labels(cutout_);
  patch.put_back(mesh, changed, labels);
  cutout_.work().grow(mesh);
  change.vertices = patch.vertices();
  for (std::size_t v = n_vertices; v < mesh.n_vertices(); ++v) change.vertices.push_back(VertexHandle(v));
  slots_.n_vertices += mesh.n_vertices() - n_vertices;
  std::vector<std::uint64_t> numbers(static_cast<std::size_t>(slots_.n_vertices));
  std::iota(numbers.begin(), numbers.end(), parts_.n_vertices());
  cutout_.number_new_vertices(std::move(numbers));
  change.labels = labels.changes();
  own_new_vertices(change);
  n_cells_ = n_cells_ - n_old + n_new;
  changes_.push_back(std::move(change));
}

/// The owner of the neighbour with the smallest number, of those that have one.
void CutoutPatches::own_new_vertices(const Change& change) {
  constexpr int kNobody = -1;
  new_owner_.resize(static_cast<std::size_t>(slots_.n_vertices), kNobody);
  const TetMesh& mesh = cutout_.mesh();
  const std::size_t n_before = mesh.n_vertices() - new_owner_.size();
  const auto owner = [&](VertexHandle v) {
    return cutout_.is_new(v) ? new_owner_[v.idx() - n_before] : cutout_.record(v).owner;
  };
  const auto first_neighbour = [&](VertexHandle v) {
    VertexHandle first;
    for (CellHandle c : change.cells)
      if (mesh.cell(c).has(v))
        for (VertexHandle u : mesh.cell(c).v)
          if (owner(u) != kNobody && (!first.is_valid() || u < first)) first = u;
    return first;
  };
  std::vector<VertexHandle> left;
  std::copy_if(change.vertices.begin(), change.vertices.end(), std::back_inserter(left),
               [&](VertexHandle v) { return cutout_.is_new(v); });
  while (!left.empty()) {
    const std::size_t n_left = left.size();
    std::erase_if(left, [&](VertexHandle v) {
      const VertexHandle first = first_neighbour(v);
      if (first.is_valid()) new_owner_[v.idx() - n_before] = owner(first);
      return first.is_valid();
    });
    if (left.size() == n_left) throw InternalError("a patch has a vertex that hangs on nothing");
  }
}

void CutoutPatches::say(Packer& said) {
  TetMesh& mesh = cutout_.mesh();
  Workspace& work = cutout_.work();
  const std::size_t n_before = mesh.n_vertices() - new_owner_.size();
  work.star_size = star_sizes(mesh);
  const std::vector<std::uint8_t> constrained = constrained_vertices(mesh, {});
  for (std::size_t v = n_before; v < mesh.n_vertices(); ++v) work.frozen[v] = constrained[v];
  said.put(slots_);
  std::vector<std::uint64_t> freed;
  for (CellHandle c : TetMesh::Writer(mesh).free_cells()) freed.push_back(cutout_.number(c));
  said.put_all(freed);
  for (const Change& change : changes_) {
    std::vector<std::uint64_t> deleted;
    std::vector<VertexHandle> vertices;
    std::vector<DistributedMesh::VertexRecord> records;
    for (VertexHandle v : change.vertices) {
      if (mesh.is_deleted(v)) {
        deleted.push_back(cutout_.number(v));
        continue;
      }
      vertices.push_back(v);
      DistributedMesh::VertexRecord& r = records.emplace_back(cutout_.record(v));
      if (cutout_.is_new(v)) r.owner = new_owner_[v.idx() - n_before];
    }
    std::vector<DistributedMesh::CellRecord> cells;
    for (CellHandle c : change.cells) cells.push_back(cutout_.record(c));
    said.put_all(change.removed);
    said.put_all(deleted);
    said.put_all(records);
    said.put_all(cells);
    said.put_all(cutout_.labels_of(change.cells, vertices));
    said.put_all(change.labels.set);
    said.put_all(change.labels.gone);
  }
}

}  // namespace

PatchesDone search_patches_in_parts(DistributedMesh& parts, std::span<const std::uint64_t> cells, int layers,
                                    const PartSurface* surface,
                                    const std::function<PatchesDone(PatchPlace&)>& search) {
  std::vector<std::uint64_t> ascending(cells.begin(), cells.end());
  std::ranges::sort(ascending);
  const std::vector<std::uint8_t> depth(cells.size(), static_cast<std::uint8_t>(layers));
  Packer first;
  {
    Cutout cutout(parts, ascending, depth, Cutout::Where::kOnAll);
    CutoutPatches place(cutout, parts, cells, surface);
    const PatchesDone done = search(place);
    if (parts.comm().rank() == 0) {
      first.put(done);
      place.say(first);
    }
  }
  const std::vector<std::byte> said = told_by_first(parts.comm(), first);
  Unpacker in(said);
  const auto done = in.get<PatchesDone>();
  const auto slots = in.get<SlotChange>();
  change_slots(parts, slots, in.get_all<std::uint64_t>());
  if (done.n_changed == 0) return done;
  NearChange near;
  std::vector<LabelChanges> labels;
  const auto append = [&]<class T>(std::vector<T>& list, bool is_near) {
    const std::vector<T> more = in.get_all<T>();
    if (is_near) list.insert(list.end(), more.begin(), more.end());
  };
  while (!in.at_end()) {
    const bool is_near = near.remove(parts, in.get_all<std::uint64_t>());
    append(near.deleted, is_near);
    append(near.come.vertices, is_near);
    append(near.come.cells, is_near);
    append(near.come.labels, is_near);
    LabelChanges& changes = labels.emplace_back();
    changes.set = in.get_all<DistributedMesh::LabelledFace>();
    changes.gone = in.get_all<LabelOrder::Face>();
  }
  write_home(parts, near);
  for (const LabelChanges& changes : labels) {
    parts.change_face_labels({}, changes.set);
    parts.change_face_labels(changes.gone, {});
  }
  // All of a part counts as changed, where in shared memory a patch does: passes after it begin anew, so that
  // nobody can tell.
  Workspace& work = parts.work();
  std::fill(work.changed.begin(), work.changed.end(), work.clock);
  std::fill(work.pending.begin(), work.pending.end(), 0xff);
  std::fill(work.claim.begin(), work.claim.end(), kUnclaimed);
  work.all_touched = true;
  parts.find_pinched();
  return done;
}

}  // namespace hfr::mpi

// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/Round.hh"

#include <algorithm>
#include <chrono>
#include <string>
#include <unordered_set>
#include <utility>

#include "HalfFace/Errors.hh"
#include "HalfFace/Writer.hh"
#include "Operators/PinchedStars.hh"
#include "Operators/WriteCells.hh"
#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"
#include "Scheduler/Rank.hh"
#include "Scheduler/RoundPlace.hh"
#include "Scheduler/Select.hh"
#ifdef HFR_PARANOID
#include "Scheduler/Paranoid.hh"
#endif

namespace hfr::detail {
namespace {

constexpr double kCommitNanoseconds = 3'000;

/// Outer faces of a part's winners, in pieces that never grow beyond what they were made for.
using Notes = std::vector<std::vector<OuterFace>>;

std::vector<OuterFace>& room_for(std::size_t n, Notes& notes) {
  constexpr std::size_t kPiece = 8192;
  if (notes.empty() || notes.back().size() + n > notes.back().capacity()) {
    notes.emplace_back();
    notes.back().reserve(std::max(kPiece, n));
  }
  return notes.back();
}

/// Labels that go over to the faces of one winner.
struct Inheritance {
  std::vector<Heir> heirs;
  VertexHandle new_vertex;
};

/// Several winners may write the same value.
void store(auto& place, auto value) {
  par::before_shared_access();
  par::atomic(place).store(value, std::memory_order_relaxed);
}

}  // namespace

class RoundCore::State {
 public:
  struct Winner {
    std::uint32_t candidate = 0;
    std::uint32_t rank = 0;
    VertexHandle new_vertex, removed_vertex;
    std::size_t first_slot = 0;
    std::span<OuterFace> notes;
    std::vector<std::uint64_t> fresh;  // slots, where the mesh is a part of one
  };

  State(RoundCore& round, bool ranks_by_gain)
      : round_(round),
        ranks_by_gain_(ranks_by_gain),
        mesh_(round.mesh_),
        writer_(round.mesh_),
        work_(round.work_),
        options_(round.options_) {}

  RoundCounts run() {
    using Clock = std::chrono::steady_clock;
    const auto since = [](Clock::time_point t) {
      return std::chrono::duration<double>(Clock::now() - t).count();
    };
    RoundCounts counts;
    counts.rounds = 1;
    auto start = Clock::now();
    counts.seeds = round_.evaluate();
    counts.candidates = round_.n_candidates();
    counts.seconds_evaluate = since(start);
    start = Clock::now();
    rank_all();
    if (options_.place) {
      select_among_parts(counts);
    } else {
      counts.sub_rounds = select();
      const std::size_t n_selected = winners_.size();
      keep_number_of_cells();
      counts.winners = winners_.size();
      counts.held_back = n_selected - winners_.size();
    }
    counts.seconds_select = since(start);
    start = Clock::now();
    ++work_.clock;
    if (!winners_.empty()) commit();
    if (options_.place) finish_among_parts();
    counts.seconds_commit = since(start);
    return options_.place ? options_.place->total(counts) : counts;
  }

  const std::vector<Winner>& winners() const { return winners_; }

  bool needs_admission() {
    pinched_stars_ = PinchedStars(mesh_, work_.pinched, options_.policy);
    const Labels& labels = mesh_.labels();
    return options_.check_links || mesh_.has_regions() || !labels.faces.empty() || !labels.edges.empty() ||
           !labels.vertices.empty() || !mesh_.locks().empty() || !work_.pinched.empty();
  }

  bool may_be_committed(const PlanBase& plan, bool check, Cavity& cavity, Star& scratch) const {
    const bool damaged = !(plan.old_worst > 0);
    if (!check && !damaged) return true;
    round_.cavity(plan, cavity);
    if (cavity.moved.is_valid() && !work_.pinched.empty() && work_.pinched[cavity.moved.idx()]) return false;
    const StarKnowledge known{work_.star_size, &pinched_stars_, work_.frozen};
    if (!admissible(mesh_, cavity, options_.check_links, scratch, known)) return false;
    if (!options_.check_links && holds_links(cavity) && makes_twice(mesh_, cavity, scratch, known))
      return false;
    return !((damaged || options_.check_links) && worsens_damage(plan, cavity));
  }

 private:
  /// Whether two winners might make the same edge or face.
  bool forbids_twice() const { return options_.check_links || !work_.pinched.empty(); }

  bool holds_links(const Cavity& cavity) const {
    return options_.check_links || work_.has_two_pinched(mesh_, cavity.removed);
  }

  /// By the metric as well as by the volumes of the cells.
  bool worsens_damage(const PlanBase& plan, const Cavity& cavity) const {
    Scope star;
    if (cavity.moved.is_valid()) round_.scope(plan, star);
    using Cells = std::span<const CellHandle>;
    const Cells cells = cavity.moved.is_valid() ? Cells(star) : Cells(cavity.removed);
    std::ptrdiff_t more = 0;
    const auto is_invalid = [&](const Tet& t) {
      const auto at = [&](VertexHandle v) {
        return v == Cavity::kNewVertex ? *cavity.new_vertex
               : v == cavity.moved     ? cavity.target
                                       : mesh_.point(v);
      };
      return !(round_.quality(at(t[0]), at(t[1]), at(t[2]), at(t[3])) > 0);
    };
    for (CellHandle c : cells) {
      if (!(work_.quality[c.idx()] > 0)) --more;
      if (cavity.moved.is_valid() && is_invalid(mesh_.cell(c).v)) ++more;
    }
    for (const Tet& t : cavity.created)
      if (is_invalid(t)) ++more;
    return more > 0 || (work_.holds_damage && hfr::worsens_damage(mesh_, cavity, cells, work_.floor));
  }

  std::uint64_t key(const PlanBase& plan, const Tet& identity) const {
    const std::uint64_t salt = options_.seed + work_.clock;
    const SeedName name = name_in_whole(identity);
    return ranks_by_gain_ ? priority_by_gain(plan.old_worst, plan.new_worst, name, salt)
                          : priority(plan.old_worst, name, salt);
  }

  SeedName name_in_whole(const Tet& identity) const {
    if (!options_.place) return name_of(identity);
    SeedName name{};
    for (std::size_t i = 0; i < name.size(); ++i)
      name[i] = identity[i].is_valid() ? options_.place->number(identity[i]) : kNoVertex;
    return name;
  }

  void rank_all() {
    const std::size_t n = round_.n_candidates();
    identities_.resize(n);
    keys_.resize(n);
    par::for_each(options_.policy, n, [&](std::size_t i) {
      const PlanBase& plan = round_.candidate(i);
      identities_[i] = round_.identity(plan);
      keys_[i] = {key(plan, identities_[i]), static_cast<std::uint32_t>(i)};
    });
    rank(options_.policy, keys_, scratch_, identities_);
    if (!options_.worst_first) return;
    for (par::KeyIndex& key : keys_) key.key = worst_first(round_.candidate(key.index).old_worst);
    par::stable_sort(options_.policy, keys_, scratch_);
  }

  /// In rank order, a candidate wins when no cell of its scope is taken.
  std::size_t select() {
    scopes_ = ScopeList(options_.policy, keys_.size(), [&](std::size_t i, Scope& out) {
      const PlanBase& plan = round_.candidate(keys_[i].index);
      round_.scope(plan, out);
      require_sizes(plan, out.size());
    });
    std::size_t sub_rounds = 1;
    std::vector<std::uint32_t> ranks;
    if (forbids_twice()) {
      Cavity cavity;
      std::unordered_set<std::uint64_t> created;
      ranks = select_by_marking(scopes_, work_.claim, [&](std::size_t i) {
        return creates_nothing_twice(round_.candidate(keys_[i].index), cavity, created);
      });
    } else {
      ranks = hfr::select(options_.policy, scopes_, work_.claim, &sub_rounds);
    }
    winners_.clear();
    for (std::uint32_t r : ranks) winners_.push_back({keys_[r].index, r, {}, {}, 0, {}, {}});
    return sub_rounds;
  }

  /// The same where the mesh is a part of one, bounds on cells included: winners are those that are committed
  /// here, among them candidates of other parts.
  void select_among_parts(RoundCounts& counts) {
    HFR_REQUIRE(!options_.worst_first, "a round over parts of a mesh does not rank by the exact worst cell");
    scopes_ = ScopeList(options_.policy, keys_.size(), [&](std::size_t i, Scope& out) {
      const PlanBase& plan = round_.candidate(keys_[i].index);
      round_.scope(plan, out);
      require_sizes(plan, out.size());
    });
    RoundPlace::Selected selected =
        options_.place->select(Offered(*this), options_.may_lose, options_.may_gain, forbids_twice());
    counts.held_back = selected.held_back;
    winners_.clear();
    for (RoundPlace::Winner& one : selected.winners) {
      const bool is_own = one.candidate != RoundPlace::Winner::kOfOthers;
      if (is_own) ++counts.winners;
      const std::size_t number = is_own ? keys_[one.candidate].index : round_.add_candidate(one.seed);
      winners_.push_back({static_cast<std::uint32_t>(number),
                          static_cast<std::uint32_t>(winners_.size()),
                          {},
                          {},
                          0,
                          {},
                          std::move(one.fresh)});
    }
    scopes_ = {};  // before there are others
    scopes_ = ScopeList(options_.policy, winners_.size(),
                        [&](std::size_t w, Scope& out) { round_.scope(plan_of(winners_[w]), out); });
    for (std::size_t w = 0; w < winners_.size(); ++w)
      for (CellHandle c : scopes_[w]) work_.claim[c.idx()] = static_cast<std::uint32_t>(w);
  }

  /// The candidates by rank.
  class Offered : public RoundPlace::Candidates {
   public:
    explicit Offered(const State& state) : state_(state) {}
    std::size_t size() const override { return state_.keys_.size(); }
    std::uint64_t key(std::size_t i) const override { return state_.keys_[i].key; }
    SeedName name(std::size_t i) const override {
      return state_.name_in_whole(state_.identities_[state_.keys_[i].index]);
    }
    SeedAddress seed(std::size_t i) const override { return state_.round_.address(plan(i)); }
    const PlanBase& plan(std::size_t i) const override {
      return state_.round_.candidate(state_.keys_[i].index);
    }
    std::span<const CellHandle> scope(std::size_t i) const override { return state_.scopes_[i]; }
    std::vector<std::uint64_t> made(std::size_t i) const override {
      if (!state_.forbids_twice()) return {};
      Cavity cavity;
      state_.round_.cavity(plan(i), cavity);
      if (!state_.holds_links(cavity)) return {};
      return state_.hashes_of_created(cavity);
    }

   private:
    const State& state_;
  };

  void finish_among_parts() {
    std::vector<RoundPlace::Commit> commits(winners_.size());
    for (std::size_t w = 0; w < winners_.size(); ++w)
      commits[w] = {scopes_[w], slots_of(w), winners_[w].removed_vertex};
    options_.place->finish(commits);
  }

  /// Slots are handed out by the plan and written by scope and cavity: in every build, and before anything is
  /// written. What else the three have to agree in, builds with assertions look at.
  static void require_sizes(const PlanBase& plan, std::size_t n_scope) {
    if (plan.n_created > Cavity::kCapacity)
      throw ResourceLimit("an operator creates " + std::to_string(plan.n_created) + " cells; at most " +
                          std::to_string(Cavity::kCapacity) + " fit into a cavity");
    HFR_REQUIRE(plan.n_removed == 0 || plan.n_removed == n_scope,
                "a plan removes " + std::to_string(plan.n_removed) +
                    " cells, and the scope of its seed has " + std::to_string(n_scope));
  }

  const PlanBase& plan_of(const Winner& winner) const { return round_.candidate(winner.candidate); }

  /// Gives up the winners that would take away or add too many cells. Serial, over winners in rank order.
  void keep_number_of_cells() {
    const auto loss = [](const PlanBase& plan) {
      return plan.removes_vertex && plan.n_removed > plan.n_created ? plan.n_removed - plan.n_created
                                                                    : std::size_t{0};
    };
    const auto gain = [](const PlanBase& plan) {
      return plan.adds_vertex && plan.n_created > plan.n_removed ? plan.n_created - plan.n_removed
                                                                 : std::size_t{0};
    };
    std::size_t lost = 0, gained = 0, n = 0;
    for (const Winner& winner : winners_) {
      lost += loss(plan_of(winner));
      gained += gain(plan_of(winner));
    }
    if (lost <= options_.may_lose && gained <= options_.may_gain) return;
    std::size_t left = options_.may_lose, room = options_.may_gain;
    for (const Winner& winner : winners_) {
      const PlanBase& plan = plan_of(winner);
      const bool stays = loss(plan) <= left && gain(plan) <= room;
      for (CellHandle c : scopes_[winner.rank])
        work_.claim[c.idx()] = stays ? static_cast<std::uint32_t>(n) : kUnclaimed;
      if (!stays) continue;
      left -= loss(plan);
      room -= gain(plan);
      winners_[n++] = winner;
    }
    winners_.resize(n);
  }

  /// Two winners that share no cell could still make the same edge in a folded mesh; the later one is
  /// refused. Hashes of 64 bits stand for the simplices: a chance collision only refuses a candidate for this
  /// round.
  bool creates_nothing_twice(const PlanBase& plan, Cavity& cavity,
                             std::unordered_set<std::uint64_t>& created) const {
    round_.cavity(plan, cavity);
    if (!holds_links(cavity)) return true;
    return add_unless_there(hashes_of_created(cavity), created);
  }

  /// By the numbers that vertices have in the whole mesh.
  std::vector<std::uint64_t> hashes_of_created(const Cavity& cavity) const {
    std::vector<std::uint64_t> hashes;
    for (const Simplex& simplex : created_simplices(mesh_, cavity)) {
      std::uint64_t h = 0;
      for (VertexHandle v : simplex) {
        const std::uint64_t number = options_.place && v.is_valid() ? options_.place->number(v) : v.idx();
        h = mix64(h ^ number) + 0x9e3779b97f4a7c15ULL;
      }
      hashes.push_back(h);
    }
    return hashes;
  }

  void commit() {
    assign_slots();
    const std::size_t n = winners_.size();
    const int n_parts = par::thread_count(options_.policy.for_items_of(kCommitNanoseconds), n);
    std::vector<Notes> notes(static_cast<std::size_t>(n_parts));
    std::vector<std::vector<Inheritance>> inheritances(static_cast<std::size_t>(n_parts));
    const bool has_labels = !mesh_.labels().faces.empty();
    const auto for_winners = [&](auto&& body) {
      par::parts(n_parts, [&](int part) {
        const std::size_t end = par::part_begin(n, n_parts, part + 1);
        for (std::size_t w = par::part_begin(n, n_parts, part); w < end; ++w)
          body(static_cast<std::size_t>(part), w);
      });
    };
    par::parts(n_parts, [&](int part) {  // commit A
      Cavity cavity;
      const std::size_t end = par::part_begin(n, n_parts, part + 1);
      for (std::size_t w = par::part_begin(n, n_parts, part); w < end; ++w) {
        Winner& winner = winners_[w];
        round_.cavity(plan_of(winner), cavity);
        HFR_ASSERT(disagreement(plan_of(winner), cavity, scopes_[winner.rank]).empty());
        winner.removed_vertex = cavity.removed_vertex;
        if (cavity.moved.is_valid()) {
          mesh_.set_point(cavity.moved, cavity.target);
          continue;
        }
        count_stars(cavity, winner.new_vertex);
        if (has_labels) note_heirs(cavity, winner.new_vertex, inheritances[static_cast<std::size_t>(part)]);
        std::vector<OuterFace>& mine =
            room_for(4 * cavity.removed.size(), notes[static_cast<std::size_t>(part)]);
        const std::size_t first = mine.size();
        write_cells(mesh_, cavity, slots_of(w), winner.new_vertex, mine);
        winner.notes = {mine.data() + first, mine.data() + mine.size()};
      }
    });
    for_winners([&](std::size_t, std::size_t w) { mend_mates(w); });
    refresh(for_winners);
    for (const auto& part : inheritances)  // in rank order
      for (const Inheritance& one : part) inherit_labels(mesh_, one.heirs, one.new_vertex);
    freeze_new_vertices();
  }

  void note_heirs(const Cavity& cavity, VertexHandle new_vertex, std::vector<Inheritance>& out) const {
    Heirs heirs;
    find_heirs(mesh_, cavity, heirs);
    if (!heirs.empty()) out.push_back({{heirs.begin(), heirs.end()}, new_vertex});
  }

  /// A new vertex of the surface must stay, as constrained_vertices() has it for the others.
  void freeze_new_vertices() {
    for (std::size_t w = 0; w < winners_.size(); ++w) {
      const VertexHandle v = winners_[w].new_vertex;
      if (!v.is_valid()) continue;
      for (CellHandle c : slots_of(w))
        for (HalfFaceHandle h : mesh_.cell_halffaces(c))
          if (mesh_.is_constrained(h) && mesh_.halfface_opposite_vertex(h) != v && mesh_.cell(c).has(v))
            work_.frozen[v.idx()] = 1;
    }
  }

  /// Keeps star_size right; winners share vertices.
  void count_stars(const Cavity& cavity, VertexHandle new_vertex) {
    const auto add = [&](VertexHandle v, std::uint32_t n) {
      par::before_shared_access();
      par::atomic(work_.star_size[v.idx()]).fetch_add(n, std::memory_order_relaxed);
    };
    for (CellHandle c : cavity.removed)
      for (VertexHandle v : mesh_.cell(c).v) add(v, static_cast<std::uint32_t>(-1));
    for (const Tet& t : cavity.created)
      for (VertexHandle v : t) add(v == Cavity::kNewVertex ? new_vertex : v, 1);
  }

  std::span<const CellHandle> slots_of(std::size_t w) const {
    return {slots_.data() + winners_[w].first_slot, plan_of(winners_[w]).n_created};
  }

  /// Before anything is written: that there is an index for each slot that is made.
  void require_room() {
    std::size_t n = 0;  // slots beyond those of removed cells
    for (const Winner& winner : winners_) {
      const PlanBase& plan = plan_of(winner);
      for (const CavityPart& p :
           parts_of(plan.n_removed, plan.n_created, plan.n_removed_first, plan.n_created_first))
        n += p.n_created > p.n_removed ? p.n_created - p.n_removed : 0;
    }
    const std::size_t n_free = options_.place ? 0 : writer_.free_cells().size();
    if (mesh_.n_cells() + (n > n_free ? n - n_free : 0) <= TetMesh::kMostCells) return;
    throw ResourceLimit("the mesh would have too many cells for the indices of this build");
  }

  /// Removed cells' slots first, then the free list from its back, then new ones; freed slots go to its back.
  /// All in rank order, so slots do not depend on threads.
  void assign_slots() {
    require_room();
    slots_.clear();
    std::vector<CellHandle>& free = writer_.free_cells();
    freed_.clear();
    std::size_t n_cells = mesh_.n_cells();
    std::vector<std::pair<CellHandle, CellHandle>>
        fresh;  // a removed cell of the cavity, a slot that it extends to
    Cavity cavity;
    for (Winner& winner : winners_) {
      const PlanBase& plan = plan_of(winner);
      const auto scope = scopes_[winner.rank];
      winner.first_slot = slots_.size();
      if (plan.n_removed == 0) continue;
      std::size_t n_fresh = 0;
      for (const CavityPart& p :
           parts_of(plan.n_removed, plan.n_created, plan.n_removed_first, plan.n_created_first)) {
        for (std::size_t i = 0; i < p.n_removed; ++i)
          (i < p.n_created ? slots_ : freed_).push_back(scope[p.first_removed + i]);
        for (std::size_t i = p.n_removed; i < p.n_created; ++i) {
          if (options_.place) {
            slots_.push_back(options_.place->slot(winner.fresh[n_fresh++]));
          } else if (free.empty()) {
            slots_.push_back(CellHandle(n_cells++));
          } else {
            slots_.push_back(free.back());
            free.pop_back();
          }
          fresh.emplace_back(scope[p.first_removed], slots_.back());
        }
      }
      if (plan.adds_vertex) {
        round_.cavity(plan, cavity);
        winner.new_vertex = mesh_.add_vertex(*cavity.new_vertex);
        mesh_.copy_vertex_data(nearest_vertex(mesh_, cavity), winner.new_vertex);
      }
    }
    writer_.resize_cells(std::max(n_cells, mesh_.n_cells()));
    work_.grow(mesh_);
    for (const auto& [from, to] : fresh) mesh_.copy_cell_data(from, to);
    if (options_.place) return;  // which hands out the slots of the whole
    for (std::size_t i = freed_.size(); i-- > 0;) free.push_back(freed_[i]);
  }

  /// Commit B: what lies behind an outer face learns of the new half-face; a neighbour that was itself
  /// replaced in this round is looked up in its winner's notes.
  void mend_mates(std::size_t w) {
    for (const OuterFace& note : winners_[w].notes) {
      if (!note.behind.is_valid()) continue;
      const std::uint32_t other = work_.claim[cell_of(note.behind).idx()];
      if (other == kUnclaimed || winners_[other].notes.empty()) {
        writer_.set_mate(note.behind, note.after);
        continue;
      }
      for (const OuterFace& theirs : winners_[other].notes)
        if (theirs.before == note.behind) writer_.set_mate(note.after, theirs.after);
    }
  }

  /// Qualities, pending bits, change stamps and incident cells (the smallest cell made in this round) of what
  /// was written.
  template <class ForWinners>
  void refresh(ForWinners&& for_winners) {
    for_winners([&](std::size_t, std::size_t w) {
      const Winner& winner = winners_[w];
      const bool moves = plan_of(winner).n_removed == 0;
      const std::span<const CellHandle> cells = moves ? scopes_[winner.rank] : slots_of(w);
      round_.measure(cells);
      for (CellHandle c : cells) {
        work_.pending[c.idx()] = 0xff;
        work_.claim[c.idx()] = kUnclaimed;
        for (VertexHandle u : mesh_.cell(c).v) {
          store(work_.changed[u.idx()], work_.clock);
          if (!moves) store(writer_.incident_cell(u), CellHandle());
        }
      }
    });
    for_winners([&](std::size_t, std::size_t w) {
      if (plan_of(winners_[w]).n_removed == 0) return;
      for (CellHandle c : slots_of(w))
        for (VertexHandle u : mesh_.cell(c).v) lower_incident_cell(u, c);
    });
    work_.touch(slots_);
    for (const Winner& winner : winners_) {
      if (plan_of(winner).n_removed == 0) work_.touch(scopes_[winner.rank]);
    }
    for (CellHandle c : freed_) {
      work_.quality[c.idx()] = std::numeric_limits<double>::infinity();
      work_.claim[c.idx()] = kUnclaimed;
    }
    for (const Winner& winner : winners_)
      if (winner.removed_vertex.is_valid()) writer_.mark_deleted(winner.removed_vertex);
  }

  /// In the order of the whole mesh.
  bool is_before(CellHandle a, CellHandle b) const {
    if (!options_.place || !b.is_valid()) return a < b;
    return options_.place->number(a) < options_.place->number(b);
  }

  void lower_incident_cell(VertexHandle v, CellHandle c) {
    const auto incident_cell = par::atomic(writer_.incident_cell(v));
    par::before_shared_access();
    CellHandle now = incident_cell.load(std::memory_order_relaxed);
    while (is_before(c, now)) {
      par::before_shared_access();
      if (incident_cell.compare_exchange_weak(now, c, std::memory_order_relaxed)) return;
    }
  }

  RoundCore& round_;
  const bool ranks_by_gain_;
  TetMesh& mesh_;
  TetMesh::Writer writer_;
  Workspace& work_;
  const RoundOptions& options_;
  std::vector<Tet> identities_;
  std::vector<par::KeyIndex> keys_, scratch_;
  PinchedStars pinched_stars_;  // before the round
  ScopeList scopes_;            // of the candidates, by rank
  std::vector<Winner> winners_;
  std::vector<CellHandle> slots_, freed_;
};

RoundCore::RoundCore(TetMesh& mesh, Workspace& work, RoundOptions options, bool ranks_by_gain)
    : mesh_(mesh), work_(work), options_(options), state_(new State(*this, ranks_by_gain)) {}
RoundCore::~RoundCore() = default;

RoundCounts RoundCore::run() {
#ifdef HFR_PARANOID
  const Paranoid paranoid(mesh_, work_, "round", typeid(*this),
                          [this](Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return quality(a, b, c, d); });
  const RoundCounts counts = state_->run();
  paranoid.look_again();
  return counts;
#else
  return state_->run();
#endif
}
bool RoundCore::needs_admission() { return state_->needs_admission(); }
bool RoundCore::may_be_committed(const PlanBase& plan, bool check, Cavity& cavity, Star& scratch) const {
  return state_->may_be_committed(plan, check, cavity, scratch);
}
std::size_t RoundCore::n_winners() const { return state_->winners().size(); }
std::size_t RoundCore::candidate_of(std::size_t winner) const { return state_->winners()[winner].candidate; }
VertexHandle RoundCore::new_vertex_of(std::size_t winner) const {
  return state_->winners()[winner].new_vertex;
}

}  // namespace hfr::detail

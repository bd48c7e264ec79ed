// SPDX-License-Identifier: BSD-3-Clause
// That a paranoid round finds what is wrong, and names it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Operators/Clusters.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/LimitMeshes.hh"
#include "Operators/SmoothNewton.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/Seeds.hh"
#include "Scheduler/SmoothPass.hh"

namespace hfr::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A box with a workspace that is right.
struct Box {
  TetMesh mesh = jittered(4, 0.3, 1);
  Workspace work;

  Box() {
    work.attach(mesh, {});
    work.set_qualities(mesh, VolumeLength{}, {});
  }

  /// What a round of the operator complains about; "" when of nothing.
  template <class Op>
  std::string complaint(Op op, bool check_links = false) {
    op.quality = work.quality;
    const Worklist all(mesh, {}, [](CellHandle) { return true; });
    Round<Op> round(mesh, work, {{}, check_links, 1});
    try {
      round.run(op, face_seeds(mesh, all, {}));
    } catch (const InternalError& error) {
      return error.what();
    }
    return "";
  }
};

using Swap = FaceSwap<VolumeLength>;

TEST(Paranoid, RoundThatKeepsItsWordGoesThrough) {
  Box box;
  EXPECT_EQ(box.complaint(Swap{}), "");
  EXPECT_EQ(box.complaint(Swap{}, true), "");
}

TEST(Paranoid, SpoiltWorkspaceIsNoticedBeforeTheRound) {
  struct Case {
    const char* complaint;
    void (*spoil)(Workspace&);
  };
  const Case cases[] = {
      {"quality of cell 17 is ", [](Workspace& w) { w.quality[17] = std::nextafter(w.quality[17], 2.0); }},
      {"claim of cell 18 is 0,", [](Workspace& w) { w.claim[18] = 0; }},
      {"star_size of vertex 3 is ", [](Workspace& w) { ++w.star_size[3]; }},
      {"frozen of vertex 0 is 0, counted anew 1", [](Workspace& w) { w.frozen[0] = 0; }},
      {"frozen of vertex 62 is 1, counted anew 0", [](Workspace& w) { w.frozen[62] = 1; }},
      {"changed of vertex 5 is ", [](Workspace& w) { w.changed[5] = w.clock + 1; }},
      {"not as long as the cells", [](Workspace& w) { w.pending.pop_back(); }},
      {"not as long as the vertices", [](Workspace& w) { w.pinched.assign(3, 0); }},
      {"touched lists", [](Workspace& w) { w.clear_touched(), w.touched.push_back(1 << 20); }}};
  for (const Case& one : cases) {
    Box box;
    one.spoil(box.work);
    EXPECT_THAT(box.complaint(Swap{}),
                AllOf(HasSubstr("before a round of hfr::Round<hfr::FaceSwap<"), HasSubstr(one.complaint)));
  }
}

TEST(Paranoid, PinchedVertexThatTheWorkspaceDoesNotKnowOfIsNoticed) {
  Box box;
  box.mesh = built(pinched(2, 0.2, 1));
  box.work.attach(box.mesh, {});
  box.work.set_qualities(box.mesh, VolumeLength{}, {});
  EXPECT_EQ(box.complaint(Swap{}), "");
  box.work.pinched.clear();
  EXPECT_THAT(box.complaint(Swap{}), HasSubstr("pinched of vertex "));
}

/// Swaps faces and turns the first cell that it makes inside out.
struct SwapThatTurnsACell : Swap {
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    Swap::cavity(mesh, plan, out);
    std::swap(out.created[0][0], out.created[0][1]);
  }
};

TEST(Paranoid, CavityThatLiesIsNoticedAfterTheRound) {
  Box box;
  EXPECT_THAT(box.complaint(SwapThatTurnsACell{}),
              AllOf(HasSubstr("after a round of "), HasSubstr("SwapThatTurnsACell"), HasSubstr(": k")));
}

/// Does something to mesh or workspace while it evaluates.
template <int kind>
struct SwapThatMeddles : Swap {
  TetMesh* mesh_too = nullptr;
  Workspace* work = nullptr;

  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const {
    constexpr std::size_t kInner = 62;
    if (kind == 0) mesh_too->set_point(V(kInner), mesh.point(V(kInner)) + Vec3{1e-12, 0, 0});
    if (kind == 1) work->star_size[kInner] = 5;
    if (kind == 2) work->quality[0] = 0.125;
    return kind < 3 ? std::nullopt : Swap::evaluate(mesh, seed);
  }
};

TEST(Paranoid, OperatorThatMeddlesIsNoticedAfterTheRound) {
  Box box;
  box.work.pending.assign(box.mesh.n_cells(), 0);
  EXPECT_THAT(box.complaint(SwapThatMeddles<0>{{}, &box.mesh, &box.work}),
              AllOf(HasSubstr("after a round of "), HasSubstr("has changed and is not pending")));
  box = Box();
  EXPECT_THAT(box.complaint(SwapThatMeddles<0>{{}, &box.mesh, &box.work}), HasSubstr("does not know"));
  box = Box();
  EXPECT_THAT(box.complaint(SwapThatMeddles<1>{{}, &box.mesh, &box.work}),
              AllOf(HasSubstr("after a round of "), HasSubstr("star_size of vertex 62 is 5,")));
  box = Box();
  EXPECT_THAT(box.complaint(SwapThatMeddles<2>{{}, &box.mesh, &box.work}),
              AllOf(HasSubstr("after a round of "), HasSubstr("quality of cell 0 is 0.125,")));
}

/// Gives other values once told to.
struct Fickle : VolumeLength {
  const bool* other = nullptr;
  double operator()(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const {
    return (*other ? 0.5 : 1.0) * VolumeLength::operator()(a, b, c, d);
  }
};

/// Moves a vertex to its middle by the metric, and changes it after that.
struct FickleStep {
  bool* other;
  std::optional<Move> operator()(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle>,
                                 const Fickle&, std::span<const double>) const {
    *other = true;
    Move move;
    move.target = mesh.point(v);
    move.old_worst = 1;
    return move;
  }
};

TEST(Paranoid, MetricThatLiesIsNoticedAfterAPass) {
  bool other = false;
  Box box;
  Fickle metric;
  metric.other = &other;
  std::string complaint;
  try {
    smooth_pass(box.mesh, box.work, FickleStep{&other}, metric, std::vector<VertexHandle>{V(62)}, {});
  } catch (const InternalError& error) {
    complaint = error.what();
  }
  EXPECT_THAT(complaint, AllOf(HasSubstr("after a pass of "), HasSubstr("FickleStep: quality of cell ")));
}

}  // namespace
}  // namespace hfr::test

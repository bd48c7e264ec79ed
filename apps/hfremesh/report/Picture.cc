// SPDX-License-Identifier: BSD-3-Clause
#include "Picture.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "Angles.hh"
#include "Chart.hh"
#include "Font.hh"
#include "Raster.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::view {
namespace {

// Units of the sheet; pixels at its usual width.
constexpr int kWidth = Picture::kUsualWidth, kHeight = 1000, kMargin = 24;
constexpr int kPanelWidth = (kWidth - 3 * kMargin) / 2, kPanelHeight = 580, kPanelTop = 76;
constexpr int kLegendAt = kPanelTop + kPanelHeight + 26;
constexpr int kChartTop = kLegendAt + 28;

constexpr double kHeading = 24;
constexpr Colour kPaper = hex(0xffffff), kEdges = hex(0x33475e), kGhostColour = hex(0x5a7088);
constexpr float kGhostOpacity = 0.14F;    // of the surface that is cut away
constexpr float kInvalidOpacity = 0.85F;  // of what shines through

int left_of(int place) { return kMargin + place * (kPanelWidth + kMargin); }

/// Draws cells and faces of one mesh in one view.
class MeshPainter {
 public:
  MeshPainter(const TetMesh& mesh, const Scene& scene, const std::vector<float>& degrees, double scale)
      : mesh_(mesh),
        scene_(scene),
        degrees_(degrees),
        scale_(scale),
        projection_(scene, pixels(kPanelWidth), pixels(kPanelHeight)) {
    cut_off_.resize(mesh.n_vertices());
    for (std::size_t i = 0; i < cut_off_.size(); ++i)
      cut_off_[i] = scene.is_cut_off(mesh.point(VertexHandle(i)));
  }

  void paint(Canvas& canvas, int left, int top) const {
    const int width = pixels(kPanelWidth), height = pixels(kPanelHeight);
    Raster solid(width, height), ghost(width, height), invalid(width, height);
    for (std::size_t i = 0; i < mesh_.n_cells(); ++i) {
      const CellHandle c(i);
      const int n_off = n_cut_off(c);
      if (is_invalid(degrees_[i]))
        for (const HalfFaceHandle h : mesh_.cell_halffaces(c))
          paint_face(invalid, h, kInvalidColour, kPaper, 0.8F);
      for (const HalfFaceHandle h : mesh_.cell_halffaces(c)) paint_face_of(solid, ghost, h, n_off);
    }
    solid.overlay(ghost, kGhostOpacity, true);
    solid.overlay(invalid, kInvalidOpacity, false);
    solid.resolve(canvas, pixels(left), pixels(top));
  }

 private:
  int pixels(int units) const { return static_cast<int>(std::lround(scale_ * units)); }

  int n_cut_off(CellHandle c) const {
    int n = 0;
    for (const VertexHandle v : mesh_.cell_vertices(c)) n += cut_off_[v.idx()];
    return n;
  }

  /// A cell stays unless all of it is cut off; its faces are seen where no cell that stays covers them, and
  /// all of them where it is poor and floats.
  void paint_face_of(Raster& solid, Raster& ghost, HalfFaceHandle h, int n_cut_off_of_cell) const {
    const float degrees = degrees_[cell_of(h).idx()];
    const bool stays = n_cut_off_of_cell < 4;
    const bool poor = degrees < kPoorBelow;
    const HalfFaceHandle m = mesh_.opposite_halfface(h);
    const bool open = !m.is_valid() || n_cut_off(cell_of(m)) == 4;
    if (stays && open) {
      const Colour others = m.is_valid() ? kInsideColour : kSurfaceColour;
      paint_face(solid, h, cell_colour(degrees, others), kEdges, 0.55F);
    } else if (!stays && poor) {
      paint_face(solid, h, cell_colour(degrees, kInsideColour), kEdges, 0.55F);
    } else if (!stays && !m.is_valid()) {
      paint_face(ghost, h, kGhostColour, kEdges, 0);
    }
  }

  void paint_face(Raster& raster, HalfFaceHandle h, Colour colour, Colour edges, float edge_opacity) const {
    const auto v = mesh_.halfface_vertices(h);
    std::array<std::array<double, 3>, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) corners[i] = projection_(mesh_.point(v[i]));
    const Vec3 p = mesh_.point(v[0]);
    const Vec3 n = cross(mesh_.point(v[1]) - p, mesh_.point(v[2]) - p);
    double light = light_on(n);
    if (!mesh_.is_boundary(h)) {
      // Faces that a cut lays open point anywhere: where they are a few pixels high, that is noise.
      const double own = std::clamp((lowest_height(corners) - 1) / 7, 0.3, 1.0);
      light = own * light + (1 - own) * light_on(scene_.cut_normal);
    }
    const auto shade = static_cast<float>(0.68 + 0.34 * light);
    const auto lit = [&](float part) { return std::min(1.0F, part * shade); };
    raster.triangle(corners, {lit(colour.r), lit(colour.g), lit(colour.b)},
                    {edges, edge_opacity, 1.1 * std::max(0.8, scale_)});
  }

  /// On a face with this normal, 0 to 1: from the upper left, behind the eye, the same from both sides.
  double light_on(Vec3 n) const {
    const double length = norm(n);
    if (!(length > 0)) return 0.5;
    n = (dot(n, scene_.axes[2]) < 0 ? -1 / length : 1 / length) * n;
    constexpr double kRight = -0.36, kUp = 0.52, kNear = 0.775;
    return std::max(
        0.0, kRight * dot(n, scene_.axes[0]) + kUp * dot(n, scene_.axes[1]) + kNear * dot(n, scene_.axes[2]));
  }

  const TetMesh& mesh_;
  const Scene& scene_;
  const std::vector<float>& degrees_;
  double scale_;
  Projection projection_;
  std::vector<std::uint8_t> cut_off_;
};

}  // namespace

Picture::Picture(const TetMesh& before, const std::string& name, int width, par::Policy policy)
    : scene_(scene_of(before)), sheet_(kWidth, kHeight, kPaper, static_cast<double>(width) / kWidth) {
  add_mesh(before, name, 0, policy);
}

void Picture::add_after(const TetMesh& mesh, const std::string& name, par::Policy policy) {
  add_mesh(mesh, name, 1, policy);
}

void Picture::add_mesh(const TetMesh& mesh, const std::string& name, int place, par::Policy policy) {
  const std::vector<float> degrees = smallest_dihedrals(mesh, policy);
  MeshPainter(mesh, scene_, degrees, sheet_.scale()).paint(sheet_, left_of(place), kPanelTop);
  const TextStyle word{.size = kHeading, .colour = kInk, .bold = true};
  const TextStyle count{.size = 20, .colour = kPaleInk, .align = Align::kRight};
  const std::string what = place == 0 ? "before" : "after";
  const std::string cells = fmt::format("{} cells", grouped(mesh.n_cells()));
  constexpr double kBase = 46;
  draw_text(sheet_, left_of(place), kBase, what, word);
  draw_text(sheet_, left_of(place) + kPanelWidth, kBase, cells, count);
  TextStyle file{.size = 20, .colour = kPaleInk};
  const double x = left_of(place) + text_width(what, word) + 16;
  const double room = left_of(place) + kPanelWidth - text_width(cells, count) - 20 - x;
  draw_text(sheet_, x, kBase, shortened(name, room, file), file);
  sheet_.line(left_of(place), kBase + 16, left_of(place) + kPanelWidth, kBase + 16, 1, kRule);
}

Canvas Picture::finish(const Statistics& before, const Statistics& after) const {
  Canvas sheet = sheet_;
  draw_legend(sheet, 0.5 * kWidth, kLegendAt);
  const double highest = std::max(highest_share(before), highest_share(after));
  int place = 0;
  for (const Statistics* statistics : {&before, &after}) {
    const double left = left_of(place++);
    draw_histogram(sheet, {left, kChartTop, left + kPanelWidth, kHeight - 10.0}, *statistics, highest);
  }
  return sheet;
}

}  // namespace hfr::view

// SPDX-License-Identifier: BSD-3-Clause
#include "Pack.hh"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "Angles.hh"

namespace hfr::view {
namespace {

constexpr double kListedBelow = 30;  // degrees
constexpr std::uint8_t kGoodAngle = 255;
constexpr double kStepsPerDegree = 8;
constexpr double kLargest = 65535;

std::uint8_t angle_code(float degrees) {
  if (is_invalid(degrees)) return 0;
  if (degrees >= kListedBelow) return kGoodAngle;
  return static_cast<std::uint8_t>(1 + static_cast<int>(kStepsPerDegree * degrees));
}

void put_number(std::string& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<char>(value | 0x80));
  out.push_back(static_cast<char>(value));
}

std::uint64_t zigzag(std::int64_t value) {
  return static_cast<std::uint64_t>(value) << 1 ^ static_cast<std::uint64_t>(value >> 63);
}

/// Every third bit of the result.
std::uint64_t spread(std::uint64_t bits) {
  std::uint64_t out = 0;
  for (int i = 0; i < 16; ++i) out |= (bits >> i & 1) << 3 * i;
  return out;
}

/// Lists by vertex, in one array.
struct Lists {
  explicit Lists(std::size_t n) : begin(n + 1) {}
  std::span<std::uint32_t> of(std::size_t v) {
    return {items.data() + begin[v], items.data() + begin[v + 1]};
  }

  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> items;
};

/// Calls each(vertex, item) twice, and it must say the same both times.
template <class ForEach>
Lists lists_of(std::size_t n_vertices, ForEach&& for_each) {
  Lists lists(n_vertices);
  for_each([&](std::uint32_t v, std::uint32_t) { ++lists.begin[v + 1]; });
  std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
  lists.items.resize(lists.begin.back());
  std::vector<std::size_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for_each([&](std::uint32_t v, std::uint32_t item) { lists.items[next[v]++] = item; });
  return lists;
}

class Packer {
 public:
  Packer(const TetMesh& mesh, const std::vector<float>& degrees, const std::vector<std::uint8_t>& reasons,
         const PackOptions& options)
      : mesh_(mesh), degrees_(degrees), reasons_(reasons) {
    choose_cells(options.most_cells);
    number_vertices();
  }

  PackedMesh finish() {
    put_coordinates();
    put_links();
    put_cells();
    put_skin();
    std::string all;
    for (std::size_t i = 0; i < streams_.size(); ++i) {
      packed_.sizes[i] = streams_[i].size();
      all += streams_[i];
      streams_[i] = std::string();
    }
    uLongf size = compressBound(all.size());
    packed_.deflated.resize(size);
    constexpr int kLevel = 6;
    const int status = compress2(reinterpret_cast<Bytef*>(packed_.deflated.data()), &size,
                                 reinterpret_cast<const Bytef*>(all.data()), all.size(), kLevel);
    if (status != Z_OK) throw InternalError("a mesh cannot be packed for the report");
    packed_.deflated.resize(size);
    return std::move(packed_);
  }

 private:
  enum Stream { kLow, kHigh, kLinkN, kLink, kCellN, kA, kB, kC, kAngle, kId, kReason, kSkinN, kSkin };
  static_assert(kSkin + 1 == PackedMesh::kStreams.size());
  using Corners = std::array<std::uint32_t, 4>;

  /// All cells, or those below as many degrees as there is room for.
  void choose_cells(std::size_t most) {
    for (const double below : {180.0, kListedBelow, kPoorBelow, 5.0, 1.0}) {
      cells_.clear();
      for (std::size_t i = 0; i < degrees_.size(); ++i)
        if (degrees_[i] < below) cells_.push_back(static_cast<std::uint32_t>(i));
      if (cells_.size() <= most) break;
    }
    if (cells_.size() > most) cells_.resize(most);
    packed_.n_cells = cells_.size();
    packed_.has_all_cells = cells_.size() == degrees_.size();
    for (std::size_t i = 0; i < 4 * mesh_.n_cells(); ++i)
      if (mesh_.is_boundary(HalfFaceHandle(i))) skin_.push_back(HalfFaceHandle(i));
    packed_.n_skin = skin_.size();
  }

  void number_vertices() {
    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    number_.assign(mesh_.n_vertices(), kUnused);
    for (const std::uint32_t c : cells_)
      for (const VertexHandle v : mesh_.cell_vertices(CellHandle(c))) number_[v.idx()] = 0;
    for (const HalfFaceHandle h : skin_)
      for (const VertexHandle v : mesh_.halfface_vertices(h)) number_[v.idx()] = 0;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
    std::vector<VertexHandle> used;
    for (std::size_t v = 0; v < number_.size(); ++v) {
      if (number_[v] == kUnused) continue;
      used.push_back(VertexHandle(v));
      const Vec3 p = mesh_.point(used.back());
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
      }
    }
    packed_.n_vertices = used.size();
    packed_.box_low = low;
    packed_.box_high = high;
    struct Place {
      std::uint64_t key;
      std::array<std::uint16_t, 3> at;
      VertexHandle v;
    };
    std::vector<Place> places(used.size());
    for (std::size_t k = 0; k < used.size(); ++k) {
      Place& place = places[k];
      place = {0, {}, used[k]};
      for (int i = 0; i < 3; ++i) {
        const double extent = high[i] - low[i];
        const double share = extent > 0 ? (mesh_.point(used[k])[i] - low[i]) / extent : 0;
        const auto at = static_cast<std::uint16_t>(std::lround(kLargest * std::clamp(share, 0.0, 1.0)));
        place.at[static_cast<std::size_t>(i)] = at;
        place.key |= spread(at) << i;
      }
    }
    std::sort(places.begin(), places.end(),
              [](const Place& a, const Place& b) { return std::pair(a.key, a.v) < std::pair(b.key, b.v); });
    for (std::size_t k = 0; k < places.size(); ++k) {
      number_[places[k].v.idx()] = static_cast<std::uint32_t>(k);
      at_.push_back(places[k].at);
    }
  }

  void put_coordinates() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::uint16_t last = 0;
      for (const auto& at : at_) {
        const auto step = static_cast<std::int16_t>(static_cast<std::uint16_t>(at[axis] - last));
        const auto code = static_cast<std::uint16_t>(zigzag(step));
        streams_[kLow].push_back(static_cast<char>(code & 255));
        streams_[kHigh].push_back(static_cast<char>(code >> 8));
        last = at[axis];
      }
    }
  }

  Corners corners_of(std::size_t place) const {
    Corners corners{};
    const auto& v = mesh_.cell_vertices(CellHandle(cells_[place]));
    for (std::size_t i = 0; i < 4; ++i) corners[i] = number_[v[i].idx()];
    std::sort(corners.begin(), corners.end());
    return corners;
  }

  std::array<std::uint32_t, 3> corners_of(HalfFaceHandle h) const {
    std::array<std::uint32_t, 3> corners{};
    const auto v = mesh_.halfface_vertices(h);
    for (std::size_t i = 0; i < 3; ++i) corners[i] = number_[v[i].idx()];
    std::sort(corners.begin(), corners.end());
    return corners;
  }

  /// The neighbours of larger numbers, each once.
  void put_links() {
    const auto all_edges = [&](auto&& each) {
      const auto of = [&](const auto& corners) {
        for (std::size_t i = 0; i < corners.size(); ++i)
          for (std::size_t k = i + 1; k < corners.size(); ++k) each(corners[i], corners[k]);
      };
      for (std::size_t i = 0; i < cells_.size(); ++i) of(corners_of(i));
      for (const HalfFaceHandle h : skin_) of(corners_of(h));
    };
    Lists with_repeats = lists_of(packed_.n_vertices, all_edges);
    for (std::uint32_t v = 0; v < packed_.n_vertices; ++v) {
      const auto mine = with_repeats.of(v);
      std::sort(mine.begin(), mine.end());
      const auto end = std::unique(mine.begin(), mine.end());
      links_.begin.push_back(links_.begin.back() + static_cast<std::size_t>(end - mine.begin()));
      put_number(streams_[kLinkN], static_cast<std::uint64_t>(end - mine.begin()));
      std::uint32_t last = v;
      for (auto at = mine.begin(); at != end; ++at) {
        put_number(streams_[kLink], *at - last - 1);
        links_.items.push_back(*at);
        last = *at;
      }
    }
  }

  std::uint32_t place_of(std::uint32_t v, std::uint32_t neighbour) {
    const auto mine = links_.of(v);
    return static_cast<std::uint32_t>(std::lower_bound(mine.begin(), mine.end(), neighbour) - mine.begin());
  }

  void put_cells() {
    Lists by_vertex = lists_of(packed_.n_vertices, [&](auto&& each) {
      for (std::uint32_t i = 0; i < cells_.size(); ++i) each(corners_of(i)[0], i);
    });
    std::int64_t last_id = 0;
    std::vector<std::array<std::uint32_t, 4>> mine;  // places of the three others; which cell
    for (std::uint32_t v = 0; v < packed_.n_vertices; ++v) {
      mine.clear();
      for (const std::uint32_t i : by_vertex.of(v)) {
        const Corners c = corners_of(i);
        mine.push_back({place_of(v, c[1]), place_of(v, c[2]), place_of(v, c[3]), i});
      }
      std::sort(mine.begin(), mine.end());
      put_number(streams_[kCellN], mine.size());
      std::uint32_t last = 0;
      for (const auto& [a, b, c, i] : mine) {
        put_number(streams_[kA], a - last);
        put_number(streams_[kB], b - a - 1);
        put_number(streams_[kC], c - b - 1);
        last = a;
        put_data(cells_[i], last_id);
      }
    }
  }

  void put_data(std::uint32_t cell, std::int64_t& last_id) {
    const std::uint8_t code = angle_code(degrees_[cell]);
    streams_[kAngle].push_back(static_cast<char>(code));
    if (code == kGoodAngle) return;
    put_number(streams_[kId], zigzag(static_cast<std::int64_t>(cell) - last_id));
    streams_[kReason].push_back(static_cast<char>(reasons_.empty() ? kNoReason : reasons_[cell]));
    last_id = cell;
    ++packed_.n_listed;
  }

  void put_skin() {
    Lists by_vertex = lists_of(packed_.n_vertices, [&](auto&& each) {
      for (std::uint32_t i = 0; i < skin_.size(); ++i) each(corners_of(skin_[i])[0], i);
    });
    for (std::uint32_t v = 0; v < packed_.n_vertices; ++v) {
      const auto mine = by_vertex.of(v);
      put_number(streams_[kSkinN], mine.size());
      for (const std::uint32_t i : mine) {
        const auto corners = corners_of(skin_[i]);
        const std::uint32_t b = place_of(v, corners[1]);
        put_number(streams_[kSkin], b);
        put_number(streams_[kSkin], place_of(v, corners[2]) - b - 1);
      }
    }
  }

  const TetMesh& mesh_;
  const std::vector<float>& degrees_;
  const std::vector<std::uint8_t>& reasons_;
  std::vector<std::uint32_t> cells_;
  std::vector<HalfFaceHandle> skin_;
  std::vector<std::uint32_t> number_;  // of the mesh's vertices in the pack
  std::vector<std::array<std::uint16_t, 3>> at_;
  Lists links_ = Lists(0);
  std::array<std::string, PackedMesh::kStreams.size()> streams_;
  PackedMesh packed_;
};

}  // namespace

PackedMesh pack(const TetMesh& mesh, const std::vector<float>& degrees,
                const std::vector<std::uint8_t>& reasons, const PackOptions& options) {
  return Packer(mesh, degrees, reasons, options).finish();
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  const auto byte = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) : 0U;
  };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (const int shift : {18, 12, 6, 0}) text.push_back(kDigits[three >> shift & 63]);
  }
  const std::size_t n_missing = (3 - bytes.size() % 3) % 3;
  text.replace(text.size() - n_missing, n_missing, n_missing, '=');
  return text;
}

}  // namespace hfr::view

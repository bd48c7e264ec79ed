// SPDX-License-Identifier: BSD-3-Clause
#include "IO/Hash.hh"

#include <algorithm>
#include <bit>

#include "IO/Assemble.hh"

namespace hfr::io {
namespace {

/// Takes values, not bytes, so that neither byte order nor the width of an index matters.
class Hasher {
 public:
  void add(std::uint64_t word) { state_ = mix64(state_ + 0x9e3779b97f4a7c15ULL + word); }
  void add(int value) { add(static_cast<std::uint64_t>(static_cast<std::int64_t>(value))); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  template <std::size_t N>
  void add(const std::array<Index, N>& items) {
    for (Index item : items) add(std::uint64_t{item});
  }
  void add(Vec3 p) {
    add(p.x);
    add(p.y);
    add(p.z);
  }
  /// The length goes in first, so that items cannot wander from one list into the next.
  template <class T>
  void add_all(const std::vector<T>& items) {
    add(std::uint64_t{items.size()});
    for (const T& item : items) add(item);
  }
  void add_labels(const std::vector<int>& labels) {
    const bool any = std::any_of(labels.begin(), labels.end(), [](int label) { return label != 0; });
    add_all(any ? labels : std::vector<int>());
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace

std::uint64_t mesh_hash(const MeshData& mesh) {
  Hasher hasher;
  hasher.add_all(mesh.points);
  hasher.add_all(mesh.cells);
  hasher.add_labels(mesh.regions);
  hasher.add_all(mesh.triangles);
  hasher.add_labels(mesh.triangle_labels);
  hasher.add_all(mesh.edges);
  hasher.add_labels(mesh.edge_labels);
  hasher.add_labels(mesh.vertex_labels);
  hasher.add(std::uint64_t{mesh.fixed_vertices.size()});
  for (Index v : mesh.fixed_vertices) hasher.add(std::uint64_t{v});
  return hasher.value();
}

std::uint64_t mesh_hash(const TetMesh& mesh) { return mesh_hash(disassemble(mesh)); }

std::string hash_text(std::uint64_t hash) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; hash >>= 4) text[i] = "0123456789abcdef"[hash & 15];
  return text;
}

}  // namespace hfr::io

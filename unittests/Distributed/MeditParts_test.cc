// SPDX-License-Identifier: BSD-3-Clause
// Meshes in the files of ParMmg. They are written here as ParMmg and Mmg lay them out, so that what reads
// them is not tried on what writes them alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "Distributed/Labelled.hh"

namespace hfr::test {
namespace {

enum class Kind { kTriangles, kVertices };

/// One part: its cells, and where its vertices and triangles stand in the whole.
struct PartOf {
  std::vector<std::size_t> cells, triangles, edges;
  std::vector<Index> vertices;                         // local → whole
  std::map<Index, std::size_t> local;                  // whole → local
  std::map<std::array<Index, 3>, std::size_t> plain;   // triangles for interfaces alone → local number
  std::map<std::array<Index, 3>, std::size_t> of_key;  // all triangles → local number
};

std::array<Index, 3> key(std::array<Index, 3> v) {
  std::sort(v.begin(), v.end());
  return v;
}

/// A mesh in parts as ParMmg would have it, and as one mesh with the numbers that reading gives.
class ParMmgFiles {
 public:
  /// `part`: of each cell. No triangle or edge twice; vertex labels, fixed vertices as they are.
  ParMmgFiles(io::MeshData whole, std::vector<int> part, Kind kind)
      : whole_(std::move(whole)), part_(std::move(part)), kind_(kind) {
    n_parts_ = 1 + *std::max_element(part_.begin(), part_.end());
    parts_.resize(static_cast<std::size_t>(n_parts_));
    for (std::size_t c = 0; c < whole_.cells.size(); ++c) {
      PartOf& p = parts_[static_cast<std::size_t>(part_[c])];
      p.cells.push_back(c);
      for (const Index v : whole_.cells[c]) p.local.emplace(v, 0);
      for (const auto& f : kFaceCorners)
        cells_of_[key({whole_.cells[c][f[0]], whole_.cells[c][f[1]], whole_.cells[c][f[2]]})].push_back(c);
    }
    for (PartOf& p : parts_)
      for (auto& [v, at] : p.local) at = p.vertices.size(), p.vertices.push_back(v);
    share_out();
  }

  int n_parts() const { return n_parts_; }
  /// `name`.0.mesh and so on.
  std::string text(int part) const;
  io::MeshData expected() const;

 private:
  void share_out();
  std::vector<std::pair<std::int64_t, std::size_t>> between(int a, int b) const;

  io::MeshData whole_;
  std::vector<int> part_;
  Kind kind_;
  int n_parts_ = 0;
  std::vector<PartOf> parts_;
  std::map<std::array<Index, 3>, std::vector<std::size_t>> cells_of_;
  std::map<std::array<Index, 3>, std::int64_t> number_;  // of faces between parts
};

void ParMmgFiles::share_out() {
  std::set<std::array<Index, 3>> labelled;
  for (std::size_t t = 0; t < whole_.triangles.size(); ++t) {
    labelled.insert(key(whole_.triangles[t]));
    std::set<int> parts;
    for (const std::size_t c : cells_of_.at(key(whole_.triangles[t]))) parts.insert(part_[c]);
    for (const int p : parts) {
      PartOf& one = parts_[static_cast<std::size_t>(p)];
      one.of_key[key(whole_.triangles[t])] = one.triangles.size();
      one.triangles.push_back(t);
    }
  }
  std::int64_t next = 1000;  // any numbers will do, in any order
  for (const auto& [face, cells] : cells_of_) {
    if (cells.size() < 2 || part_[cells[0]] == part_[cells[1]]) continue;
    number_[face] = next -= 3;
    if (next < 10) next = 1'000'000;
    for (const std::size_t c : cells) {
      PartOf& one = parts_[static_cast<std::size_t>(part_[c])];
      if (labelled.count(face) > 0) continue;
      const std::size_t at = one.triangles.size() + one.plain.size();
      one.plain[face] = at;
    }
  }
  for (PartOf& p : parts_) {  // plain ones stand behind the others
    std::size_t at = p.triangles.size();
    for (auto& [face, local] : p.plain) local = at, p.of_key[face] = at++;
  }
  for (std::size_t e = 0; e < whole_.edges.size(); ++e)
    for (PartOf& p : parts_) {
      const auto has = [&](std::size_t c) {
        const auto& v = whole_.cells[c];
        return std::count(v.begin(), v.end(), whole_.edges[e][0]) > 0 &&
               std::count(v.begin(), v.end(), whole_.edges[e][1]) > 0;
      };
      if (std::any_of(p.cells.begin(), p.cells.end(), has)) p.edges.push_back(e);
    }
}

/// Number in the whole, and local number in part a, of what a shares with b.
std::vector<std::pair<std::int64_t, std::size_t>> ParMmgFiles::between(int a, int b) const {
  const PartOf &mine = parts_[static_cast<std::size_t>(a)], &other = parts_[static_cast<std::size_t>(b)];
  std::vector<std::pair<std::int64_t, std::size_t>> items;
  if (kind_ == Kind::kVertices) {
    for (const auto& [v, at] : mine.local)
      if (other.local.count(v) > 0) items.emplace_back(1 + (v * 7919) % 100'003, at);
  } else {
    for (const auto& [face, number] : number_) {
      const auto& cells = cells_of_.at(face);
      const std::set<int> parts = {part_[cells[0]], part_[cells[1]]};
      if (parts == std::set<int>{a, b}) items.emplace_back(number, mine.of_key.at(face));
    }
    if (a > b) std::reverse(items.begin(), items.end());
  }
  return items;
}

std::string ParMmgFiles::text(int part) const {
  const PartOf& p = parts_[static_cast<std::size_t>(part)];
  std::ostringstream out;
  out.precision(17);
  out << "MeshVersionFormatted 2\n\nDimension 3\n\n\nVertices\n" << p.vertices.size() << "\n";
  std::set<std::size_t> parallel, fixed;
  for (const Index v : p.vertices)
    out << whole_.points[v].x << " " << whole_.points[v].y << " " << whole_.points[v].z << " "
        << (whole_.vertex_labels.empty() ? 0 : whole_.vertex_labels[v]) << "\n";
  for (const Index v : whole_.fixed_vertices)
    if (const auto at = p.local.find(v); at != p.local.end()) fixed.insert(at->second);
  for (int q = 0; q < n_parts_; ++q)
    if (q != part)
      for (const auto& [v, at] : p.local)
        if (parts_[static_cast<std::size_t>(q)].local.count(v) > 0) parallel.insert(at);
  const auto list = [&](const char* name, const std::set<std::size_t>& numbers) {
    if (numbers.empty()) return;
    out << "\n\n" << name << "\n" << numbers.size() << "\n";
    for (const std::size_t i : numbers) out << i + 1 << "\n";
  };
  std::set<std::size_t> required = fixed;
  required.insert(parallel.begin(), parallel.end());  // ParMmg keeps its interfaces as they are
  list("RequiredVertices", required);
  list("ParallelVertices", parallel);
  out << "\n\nTetrahedra\n" << p.cells.size() << "\n";
  for (const std::size_t c : p.cells) {
    for (const Index v : whole_.cells[c]) out << p.local.at(v) + 1 << " ";
    out << (whole_.regions.empty() ? 0 : whole_.regions[c]) << "\n";
  }
  out << "\n\nTriangles\n" << p.triangles.size() + p.plain.size() << "\n";
  for (const std::size_t t : p.triangles) {
    for (const Index v : whole_.triangles[t]) out << p.local.at(v) + 1 << " ";
    out << whole_.triangle_labels[t] << "\n";
  }
  std::set<std::size_t> plain;
  for (const auto& [face, at] : p.plain) {
    // Each side begins with another corner, and sees it from its own side.
    const std::size_t k = static_cast<std::size_t>(part) % 3;
    for (const std::size_t i : {k, (k + 1) % 3, (k + 2) % 3}) out << p.local.at(face[i]) + 1 << " ";
    out << "0\n";
    plain.insert(at);
  }
  list("RequiredTriangles", plain);
  list("ParallelTriangles", plain);
  if (!p.edges.empty()) out << "\n\nEdges\n" << p.edges.size() << "\n";
  for (const std::size_t e : p.edges)
    out << p.local.at(whole_.edges[e][0]) + 1 << " " << p.local.at(whole_.edges[e][1]) + 1 << " "
        << whole_.edge_labels[e] << "\n";
  out << "\nNumberOfPartitions\n" << n_parts_ << "\n";
  std::vector<std::pair<int, std::vector<std::pair<std::int64_t, std::size_t>>>> all;
  for (int q = 0; q < n_parts_; ++q)
    if (auto items = between(part, q); q != part && !items.empty()) all.emplace_back(q, std::move(items));
  const bool by_triangles = kind_ == Kind::kTriangles;
  out << (by_triangles ? "\nParallelTriangleCommunicators\n" : "ParallelVertexCommunicators\n") << all.size()
      << "\n";
  for (const auto& [q, items] : all) out << q << " " << items.size() << "\n";
  out << (by_triangles ? "\nParallelCommunicatorTriangles\n" : "\nParallelCommunicatorVertices\n");
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const auto& [number, at] : all[k].second) out << at + 1 << " " << number << " " << k << "\n";
  out << "\n\nEnd\n";
  return out.str();
}

/// Vertices by the first part that has them, cells, triangles and edges by part.
io::MeshData ParMmgFiles::expected() const {
  io::MeshData data;
  std::map<Index, Index> number;
  std::set<std::size_t> triangles, edges;
  for (const PartOf& p : parts_) {
    for (const Index v : p.vertices)
      if (number.emplace(v, static_cast<Index>(number.size())).second) {
        data.points.push_back(whole_.points[v]);
        if (!whole_.vertex_labels.empty()) data.vertex_labels.push_back(whole_.vertex_labels[v]);
      }
    for (const std::size_t c : p.cells) {
      auto& cell = data.cells.emplace_back(whole_.cells[c]);
      for (Index& v : cell) v = number.at(v);
      if (!whole_.regions.empty()) data.regions.push_back(whole_.regions[c]);
    }
    for (const std::size_t t : p.triangles)
      if (triangles.insert(t).second) {
        auto& item = data.triangles.emplace_back(whole_.triangles[t]);
        for (Index& v : item) v = number.at(v);
        data.triangle_labels.push_back(whole_.triangle_labels[t]);
      }
    for (const std::size_t e : p.edges)
      if (edges.insert(e).second) {
        auto& item = data.edges.emplace_back(whole_.edges[e]);
        for (Index& v : item) v = number.at(v);
        data.edge_labels.push_back(whole_.edge_labels[e]);
      }
  }
  for (const Index v : whole_.fixed_vertices) {
    // What two parts share is required and parallel there, so nobody knows whether it is fixed as well.
    const auto has = [&](const PartOf& p) { return p.local.count(v) > 0; };
    if (std::count_if(parts_.begin(), parts_.end(), has) == 1) data.fixed_vertices.push_back(number.at(v));
  }
  std::sort(data.fixed_vertices.begin(), data.fixed_vertices.end());
  return data;
}

/// Each cell to one of so many blocks: slabs for seed 0, otherwise by the nearest of random points.
std::vector<int> cut(const io::MeshData& data, int n, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<Vec3> middles;
  for (int i = 0; i < n; ++i) {
    const auto random = [&] { return static_cast<double>(engine() % 1000) / 1000; };
    middles.push_back(seed == 0 ? Vec3{(i + 0.5) / n, 0.5, 0.5} : Vec3{random(), random(), random()});
  }
  std::vector<int> part;
  for (const auto& cell : data.cells) {
    Vec3 middle = {0, 0, 0};
    for (const Index v : cell) middle = middle + data.points[v] * 0.25;
    std::size_t best = 0;
    for (std::size_t i = 1; i < middles.size(); ++i)
      if (norm(middles[i] - middle) < norm(middles[best] - middle)) best = i;
    part.push_back(static_cast<int>(best));
  }
  return part;
}

/// Labels of triangles are not 0: those that lie between parts would be left out.
io::MeshData labelled_once(const TetMesh& mesh, std::uint64_t seed) {
  io::MeshData data = labelled(mesh, seed, {1, 40, 30, 9, 23, 0, true});
  for (int& label : data.edge_labels) ++label;
  data.names.clear();
  return data;
}

void write_files(const ParMmgFiles& files, const std::filesystem::path& folder) {
  for (int i = 0; i < files.n_parts(); ++i)
    std::ofstream(folder / ("in." + std::to_string(i) + ".mesh")) << files.text(i);
}

TEST(MeditParts, FilesOfParMmgHaveTheBytesOfTheirMeshInSharedMemory) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto path = folder.path() / "in.mesh";
  std::size_t n_winners = 0;
  std::uint64_t seed = 0;
  for (const Kind kind : {Kind::kTriangles, Kind::kVertices})
    for (const int n : {1, 2, 3, 7}) {
      SCOPED_TRACE(std::to_string(n) + (kind == Kind::kTriangles ? " by triangles" : " by vertices"));
      ++seed;
      const io::MeshData whole = labelled_once(valid_box(6, 0.45, seed), seed);
      const ParMmgFiles files(whole, cut(whole, n, n % 2 == 0 ? 0 : seed), kind);
      if (comm.rank() == 0) {
        for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
          std::filesystem::remove(entry);
        write_files(files, folder.path());
      }
      comm.sum(0);
      EXPECT_TRUE(mpi::has_medit_parts(comm, path));
      mpi::DistributedMesh parts(comm);
      mpi::read_medit_parts(parts, path);
      EXPECT_TRUE(mpi::check(parts).is_good);
      mpi::write_ranges(parts, folder.path() / "read.mesh");
      const mpi::PartsResult result = mpi::improve(parts, polish_towards(20));
      EXPECT_TRUE(mpi::check(parts).is_good);
      mpi::write_ranges(parts, folder.path() / "improved.vtu");
      if (comm.rank() == 0) {
        TetMesh mesh = io::assemble(files.expected());
        io::write(folder.path() / "whole.mesh", mesh);
        EXPECT_TRUE(bytes_of(folder.path() / "read.mesh") == bytes_of(folder.path() / "whole.mesh"));
        for (const PassReport& pass : hfr::improve(mesh, polish_towards(20)).passes)
          n_winners += pass.winners;
        io::write(folder.path() / "whole.vtu", mesh);
        EXPECT_TRUE(bytes_of(folder.path() / "improved.vtu") == bytes_of(folder.path() / "whole.vtu"));
      }
      EXPECT_EQ(result.before.n_cells, whole.cells.size());
      comm.sum(0);
    }
  EXPECT_GT(comm.from_first(n_winners), 500U) << "the polish no longer finds anything to do";
}

/// Of cells, triangles, edges and fixed vertices the points and labels, whatever their numbers.
std::multiset<std::vector<double>> content(const io::MeshData& data) {
  std::multiset<std::vector<double>> all;
  const auto add = [&](double kind, const auto& corners, double label) {
    std::vector<std::array<double, 3>> points;
    for (const Index v : corners) points.push_back({data.points[v].x, data.points[v].y, data.points[v].z});
    std::sort(points.begin(), points.end());
    std::vector<double> one = {kind, label};
    for (const auto& p : points) one.insert(one.end(), p.begin(), p.end());
    all.insert(one);
  };
  for (std::size_t i = 0; i < data.cells.size(); ++i)
    add(3, data.cells[i], data.regions.empty() ? 0 : data.regions[i]);
  for (std::size_t i = 0; i < data.triangles.size(); ++i) add(2, data.triangles[i], data.triangle_labels[i]);
  for (std::size_t i = 0; i < data.edges.size(); ++i) add(1, data.edges[i], data.edge_labels[i]);
  for (std::size_t i = 0; i < data.points.size(); ++i)
    add(0, std::array<Index, 1>{static_cast<Index>(i)},
        data.vertex_labels.empty() ? 0 : data.vertex_labels[i]);
  for (const Index v : data.fixed_vertices) add(-1, std::array<Index, 1>{v}, 0);
  return all;
}

TEST(MeditParts, WhatIsWrittenComesBack) {
  mpi::Comm comm(MPI_COMM_WORLD);
  const SharedFolder folder(comm);
  const auto in = folder.path() / "in.vtu", out = folder.path() / "out.mesh";
  const io::MeshData whole = labelled_once(valid_box(6, 0.45, 3), 3);
  if (comm.rank() == 0) io::write_mesh(in, whole);
  comm.sum(0);
  mpi::DistributedMesh parts(comm);
  mpi::read_ranges(parts, in);
  mpi::improve(parts, polish_towards(12));
  EXPECT_THAT(mpi::write_medit_parts(parts, out), testing::IsEmpty());
  mpi::write_ranges(parts, folder.path() / "whole.vtu");
  mpi::DistributedMesh again(comm);
  mpi::read_medit_parts(again, out);
  EXPECT_TRUE(mpi::check(again).is_good);
  mpi::write_ranges(again, folder.path() / "again.vtu");
  if (comm.rank() != 0) return;
  EXPECT_TRUE(content(io::read_mesh(folder.path() / "whole.vtu")) ==
              content(io::read_mesh(folder.path() / "again.vtu")));
  for (int r = 0; r < comm.size(); ++r) {
    // Each is a Medit file as well, with the triangles and numbers that ParMmg looks for.
    const std::string text = bytes_of(folder.path() / ("out." + std::to_string(r) + ".mesh"));
    EXPECT_THAT(text, testing::ContainsRegex("NumberOfPartitions\n" + std::to_string(comm.size()) + "\n"));
    EXPECT_GT(io::read_mesh(folder.path() / ("out." + std::to_string(r) + ".mesh")).cells.size(), 0U);
  }
}

/// The line with which a file is refused that is put in the place of part 1.
class Refusals {
 public:
  explicit Refusals(const ParMmgFiles& files) {
    if (world_.rank() == 0) write_files(files, folder_.path());
    world_.sum(0);
  }
  std::string of(const std::string& text) {
    world_.sum(0);
    if (world_.rank() == 0) std::ofstream(folder_.path() / "in.1.mesh") << text;
    world_.sum(0);
    return refusal_of(
        [&](mpi::DistributedMesh& parts) { mpi::read_medit_parts(parts, folder_.path() / "in.mesh"); });
  }
  void remove(const char* name) {
    if (world_.rank() == 0) std::filesystem::remove(folder_.path() / name);
    world_.sum(0);
  }

 private:
  mpi::Comm world_{MPI_COMM_WORLD};
  SharedFolder folder_{world_};
};

ParMmgFiles three_parts(Kind kind) {
  const io::MeshData whole = labelled_once(valid_box(2, 0.2, 5), 5);
  return {whole, cut(whole, 3, 0), kind};
}

TEST(MeditParts, FilesThatAreCutAreRefusedOnAllRanks) {
  for (const Kind kind : {Kind::kTriangles, Kind::kVertices}) {
    const ParMmgFiles files = three_parts(kind);
    const std::string good = files.text(1);
    Refusals refusal(files);
    EXPECT_EQ(refusal.of(good), "");
    int n_refused = 0;
    for (std::size_t end = good.find('\n'); end + 1 < good.size(); end = good.find('\n', end + 1)) {
      const std::string text = good.substr(0, end + 1);
      if (text.find("End") != std::string::npos) break;
      const std::string line = refusal.of(text);
      EXPECT_THAT(line, testing::HasSubstr("in.1.mesh:")) << "cut behind\n" << text;
      EXPECT_EQ(line.find('\n'), std::string::npos);
      ++n_refused;
    }
    EXPECT_GT(n_refused, 100);
    EXPECT_THAT(refusal.of(""), testing::HasSubstr("in.1.mesh: the file is empty"));
  }
}

/// `text` with the first `from` behind the line `section` replaced.
std::string replaced(std::string text, const std::string& section, const std::string& from,
                     const std::string& to) {
  const std::size_t begin = text.find(section);
  const std::size_t at = text.find(from, begin + section.size());
  EXPECT_NE(begin, std::string::npos) << section;
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(MeditParts, FilesThatSayWhatIsNotThereAreRefused) {
  using testing::HasSubstr;
  const ParMmgFiles files = three_parts(Kind::kVertices);
  const std::string good = files.text(1);
  const std::string items = "ParallelCommunicatorVertices\n", heads = "ParallelVertexCommunicators\n";
  Refusals refusal(files);
  EXPECT_EQ(refusal.of(good), "");
  EXPECT_THAT(refusal.of(replaced(good, "NumberOfPartitions\n", "3", "4")),
              HasSubstr("in.1.mesh: it is one of 4 parts, and there are files of 3"));
  const auto expect_with_heads = [&](const std::string& from, const std::string& to, const char* what) {
    EXPECT_THAT(refusal.of(replaced(good, heads, from, to)),
                testing::AllOf(HasSubstr("in.1.mesh:"), HasSubstr(what)))
        << from << " → " << to;
  };
  const std::size_t head_at = good.find(heads) + heads.size() + 2;  // behind "2\n"
  const std::string head = good.substr(head_at, good.find('\n', head_at) - head_at), n_items = head.substr(2);
  const auto more = [&](int by) { return "0 " + std::to_string(std::stoi(n_items) + by); };
  expect_with_heads("2\n" + head, "3\n" + head, "ParallelVertexCommunicators announces 3 entries and has 2");
  expect_with_heads("2\n" + head, "1\n" + head, "expected a keyword");
  expect_with_heads("2\n" + head, "999999999\n" + head, "announces 999999999 entries");
  expect_with_heads(head, more(-1), "communicator 0 announces");
  expect_with_heads(head, more(1), "ParallelCommunicatorVertices announces");
  expect_with_heads(head, "0 999999999", "ParallelCommunicatorVertices announces");
  expect_with_heads(head, "0 0", "number of items");
  EXPECT_THAT(refusal.of(replaced(good, heads, "0 ", "1 ")),
              HasSubstr("its communicator with part 1 is one with no other of the 3 parts"));
  EXPECT_THAT(refusal.of(replaced(good, heads, "0 ", "7 ")),
              HasSubstr("its communicator with part 7 is one with no other of the 3 parts"));
  EXPECT_THAT(refusal.of(replaced(good, heads, "0 ", "2 ")),
              HasSubstr("its communicator with part 2 comes twice"));
  const std::size_t at = good.find(items) + items.size(), end = good.find('\n', at);
  const std::string first = good.substr(at, end - at);
  const std::string local = first.substr(0, first.find(' ')), rest = first.substr(first.find(' '));
  EXPECT_THAT(refusal.of(replaced(good, items, first, "999" + rest)),
              HasSubstr("item 999 of vertices between parts is out of range"));
  EXPECT_THAT(refusal.of(replaced(good, items, first, local + " 77 0")), HasSubstr("has the global number"));
  EXPECT_THAT(refusal.of(replaced(good, items, first, local + " -1 0")), HasSubstr("global number"));
  EXPECT_THAT(refusal.of(replaced(good, items, first, first.substr(0, first.size() - 1) + "2")),
              HasSubstr("communicator"));
  EXPECT_THAT(refusal.of(replaced(good, items, first, first.substr(0, first.size() - 1) + "1")),
              HasSubstr("communicator"));
  const std::size_t second_at = end + 1;
  const std::string second = good.substr(second_at, good.find('\n', second_at) - second_at);
  EXPECT_THAT(refusal.of(replaced(good, items, first, second.substr(0, second.find(' ')) + rest)),
              HasSubstr("the points are others there"));
  EXPECT_THAT(
      refusal.of(good.substr(0, good.find(heads)) + "End\n"),
      testing::AnyOf(HasSubstr("has no communicator with part"), HasSubstr("which has none with it")));
  EXPECT_THAT(refusal.of(three_parts(Kind::kTriangles).text(1)),
              testing::AnyOf(HasSubstr("items, and"), HasSubstr("of triangles on one side")));
  EXPECT_EQ(refusal.of(good), "");
  refusal.remove("in.2.mesh");
  EXPECT_THAT(refusal.of(good), HasSubstr("it is one of 3 parts, and there are files of 2"));
  refusal.remove("in.0.mesh");
  EXPECT_THAT(refusal.of(good), HasSubstr("in.0.mesh: there is no such file"));
}

/// Wherever a rank fails while parts are written, the files that were there stay.
TEST(MeditParts, ARankThatFailsLeavesTheFilesThatWereThere) {
  mpi::Comm world(MPI_COMM_WORLD);
  if (world.size() == 1) GTEST_SKIP() << "one rank fails alone";
  const SharedFolder folder(world);
  const auto out = folder.path() / "out.mesh";
  const auto mine = folder.path() / ("out." + std::to_string(world.rank()) + ".mesh");
  const auto run = [&](std::uint64_t call) -> std::uint64_t {
    mpi::Comm comm(MPI_COMM_WORLD);
    std::uint64_t before = 0;
    try {
      mpi::DistributedMesh parts(comm);
      mpi::GridOptions options;
      options.cavity.counts = {4, 4, 4};
      mpi::generate_in_parts(parts, options);
      before = comm.n_calls();
      if (comm.rank() == comm.size() - 1 && call > 0) comm.fail_at_call(before + call);
      mpi::write_medit_parts(parts, out);
      EXPECT_EQ(call, 0U);
    } catch (const mpi::RankFailed& failed) {
      EXPECT_EQ(failed.rank(), world.size() - 1);
    } catch (const ResourceLimit& error) {
      EXPECT_EQ(comm.fail(5, error.what()).rank(), world.size() - 1);
    }
    return comm.n_calls() - before;
  };
  std::ofstream(mine) << "what was there";
  world.sum(0);
  const std::uint64_t n_calls = [&] {
    mpi::Comm comm(MPI_COMM_WORLD);
    return run(0);
  }();
  EXPECT_NE(bytes_of(mine), "what was there");
  std::ofstream(mine) << "what was there";
  for (std::uint64_t call = 1; call < n_calls; ++call) run(call);
  EXPECT_EQ(bytes_of(mine), "what was there");
  world.sum(0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), world.size());
  world.sum(0);
}

TEST(MeditParts, RanksWithoutCellsCannotBeWritten) {
  mpi::Comm world(MPI_COMM_WORLD);
  if (world.size() == 1) GTEST_SKIP() << "one rank has all cells";
  const SharedFolder folder(world);
  if (world.rank() == 0) {
    io::MeshData data;
    data.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    data.cells = {{0, 1, 2, 3}};
    io::write_mesh(folder.path() / "in.mesh", data);
  }
  world.sum(0);
  mpi::Comm comm(MPI_COMM_WORLD);
  std::string refusal;
  try {
    mpi::DistributedMesh parts(comm);
    mpi::read_ranges(parts, folder.path() / "in.mesh");
    mpi::write_medit_parts(parts, folder.path() / "out.mesh");
  } catch (const mpi::RankFailed& failed) {
    refusal = failed.what();
  } catch (const InvalidInput& error) {
    refusal = comm.fail(2, error.what()).what();
  }
  EXPECT_THAT(refusal, testing::HasSubstr("has no cells, and ParMmg takes no part without"));
  world.sum(0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  world.sum(0);
}

}  // namespace
}  // namespace hfr::test

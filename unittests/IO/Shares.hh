// SPDX-License-Identifier: BSD-3-Clause
// All shares of a file, read by threads in place of processes and put together again.
#ifndef HFR_UNITTESTS_IO_SHARES_HH
#define HFR_UNITTESTS_IO_SHARES_HH

#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "IO/MeshData.hh"
#include "IO/MeshShare.hh"

namespace hfr::io::samples {

/// Where the threads hear what all have said.
class Meeting {
 public:
  struct Ended {};  ///< thrown in those that wait for one that has left

  explicit Meeting(std::size_t n) : said_(n), barrier_(static_cast<std::ptrdiff_t>(n)) {}

  Processes as(std::size_t rank) {
    return {rank, said_.size(), [this, rank](std::span<const std::byte> mine) {
              said_[rank].assign(mine.begin(), mine.end());
              barrier_.arrive_and_wait();
              if (has_ended_) throw Ended();
              std::vector<std::byte> all;
              for (const auto& one : said_) all.insert(all.end(), one.begin(), one.end());
              barrier_.arrive_and_wait();
              return all;
            }};
  }
  /// Of who has thrown, and says nothing more.
  void leave() {
    has_ended_ = true;
    barrier_.arrive_and_drop();
  }

 private:
  std::vector<std::vector<std::byte>> said_;
  std::barrier<> barrier_;
  std::atomic<bool> has_ended_ = false;
};

/// What one process reads.
struct Share {
  SharePoints points;
  std::vector<ShareItems> items;
  std::map<std::pair<int, int>, std::string> names;
  std::vector<std::string> notes;
  std::uint64_t n_points = 0, n_cells = 0;
};

inline Share read_share(const std::filesystem::path& path, const Processes& processes,
                        std::uint64_t at_once) {
  const std::unique_ptr<MeshShare> file = open_share(path, processes, at_once);
  Share share;
  share.n_points = file->n_points();
  share.n_cells = file->n_cells();
  share.names = file->names();
  share.notes = file->notes();
  share.points = file->points();
  for (std::size_t i = 0; i < file->n_portions(); ++i) share.items.push_back(file->portion(i));
  return share;
}

/// The shares of n processes. What one of them throws is thrown.
inline std::vector<Share> read_shares(const std::filesystem::path& path, std::size_t n,
                                      std::uint64_t at_once) {
  Meeting meeting(n);
  std::vector<Share> shares(n);
  std::vector<std::exception_ptr> errors(n);
  const auto read = [&](std::size_t rank) {
    try {
      shares[rank] = read_share(path, meeting.as(rank), at_once);
      return;
    } catch (const Meeting::Ended&) {
    } catch (...) {
      errors[rank] = std::current_exception();
    }
    meeting.leave();
  };
  std::vector<std::thread> threads;
  for (std::size_t rank = 1; rank < n; ++rank) threads.emplace_back(read, rank);
  read(0);
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  return shares;
}

/// Elements whose numbers follow on those that are there already.
template <std::size_t N>
void append(const ShareElements<N>& from, std::vector<std::array<Index, N>>& elements,
            std::vector<int>& labels) {
  if (!from.corners.empty() && from.first != elements.size())
    throw std::logic_error("numbers of elements do not follow on one another");
  for (const auto& corners : from.corners) {
    auto& v = elements.emplace_back();
    std::transform(corners.begin(), corners.end(), v.begin(),
                   [](std::uint64_t number) { return static_cast<Index>(number); });
  }
  labels.insert(labels.end(), from.labels.begin(), from.labels.end());
}

/// All of them as one mesh, as comparable() makes it. Throws std::logic_error where they do not fit.
inline MeshData put_together(const std::vector<Share>& shares) {
  MeshData mesh;
  mesh.names = shares[0].names;
  mesh.vertex_labels.resize(shares[0].n_points);
  const auto label = [&](std::uint64_t vertex, int value) {
    if (mesh.vertex_labels.at(vertex) == 0) mesh.vertex_labels[vertex] = value;  // the first is taken
  };
  const auto fix = [&](std::uint64_t vertex) { mesh.fixed_vertices.push_back(static_cast<Index>(vertex)); };
  for (const Share& share : shares) {
    const SharePoints& read = share.points;
    if (read.first != mesh.points.size()) throw std::logic_error("points do not follow on one another");
    mesh.points.insert(mesh.points.end(), read.points.begin(), read.points.end());
    for (std::size_t i = 0; i < read.labels.size(); ++i) label(read.first + i, read.labels[i]);
    for (std::size_t i = 0; i < read.fixed.size(); ++i)
      if (read.fixed[i] != 0) fix(read.first + i);
    for (const ShareItems& items : share.items) {
      append(items.cells, mesh.cells, mesh.regions);
      append(items.triangles, mesh.triangles, mesh.triangle_labels);
      append(items.edges, mesh.edges, mesh.edge_labels);
      for (const auto& [vertex, value] : items.vertex_labels) label(vertex, value);
      std::for_each(items.fixed.begin(), items.fixed.end(), fix);
    }
    if (share.names != mesh.names || share.notes != shares[0].notes)
      throw std::logic_error("names or notes are not the same for all");
  }
  if (mesh.points.size() != shares[0].n_points || mesh.cells.size() != shares[0].n_cells)
    throw std::logic_error("there are not as many points or cells as was said");
  std::sort(mesh.fixed_vertices.begin(), mesh.fixed_vertices.end());
  mesh.fixed_vertices.erase(std::unique(mesh.fixed_vertices.begin(), mesh.fixed_vertices.end()),
                            mesh.fixed_vertices.end());
  return mesh;
}

/// What of a whole mesh its shares have, too: no fields; labels for all, in place of none.
inline MeshData comparable(MeshData mesh) {
  mesh.regions.resize(mesh.cells.size());
  mesh.vertex_labels.resize(mesh.points.size());
  mesh.point_fields.clear();
  mesh.cell_fields.clear();
  return mesh;
}

}  // namespace hfr::io::samples

#endif

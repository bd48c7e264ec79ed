// SPDX-License-Identifier: BSD-3-Clause
#include "Locks.hh"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "ExitCode.hh"
#include "Numbers.hh"

namespace hfr::app {
namespace {

/// What follows `prefix`, split at `separator` into `n` numbers; an empty list when the text is something
/// else.
template <class Integer>
std::vector<Integer> numbers_after(const std::string& text, const std::string& prefix, char separator,
                                   std::size_t n) {
  if (!text.starts_with(prefix)) return {};
  std::vector<Integer> numbers;
  for (std::size_t at = prefix.size(); at < text.size();) {
    const std::size_t end = std::min(text.find(separator, at), text.size());
    const auto number = integer_of<Integer>(std::string_view(text).substr(at, end - at));
    if (!number) return {};
    numbers.push_back(*number);
    at = end + 1;
  }
  if (numbers.size() != n) numbers.clear();
  return numbers;
}

/// N vertices after `prefix`; nothing when the text is something else.
template <std::size_t N>
std::optional<std::array<VertexHandle, N>> vertices_after(const std::string& text,
                                                          const std::string& prefix) {
  const auto numbers = numbers_after<std::uint64_t>(text, prefix, '-', N);
  if (numbers.empty()) return std::nullopt;
  std::array<VertexHandle, N> vertices;
  for (std::size_t i = 0; i < N; ++i) {
    if (numbers[i] >= VertexHandle::kInvalid) return std::nullopt;
    vertices[i] = VertexHandle(static_cast<Index>(numbers[i]));
  }
  return vertices;
}

}  // namespace

void add_locks(SurfaceOptions& surface, const std::vector<std::string>& fix,
               const std::vector<std::string>& periodic) {
  for (const std::string& what : fix) {
    if (const auto p = numbers_after<int>(what, "patch:", '\0', 1); !p.empty()) {
      surface.fixed_patches.push_back(p[0]);
    } else if (const auto v = vertices_after<1>(what, "vertex:")) {
      surface.fixed_vertices.push_back((*v)[0]);
    } else if (const auto e = vertices_after<2>(what, "edge:")) {
      surface.fixed_edges.push_back(*e);
    } else if (const auto f = vertices_after<3>(what, "face:")) {
      surface.fixed_faces.push_back(*f);
    } else {
      throw Failure(ExitCode::kUsage,
                    "--fix takes patch:N, vertex:N, edge:N-N and face:N-N-N, not " + in_quotes(what));
    }
  }
  for (const std::string& pair : periodic) {
    const auto patches = numbers_after<int>(pair, "", ':', 2);
    if (patches.empty())
      throw Failure(ExitCode::kUsage, "--periodic takes A:B, two patches, not " + in_quotes(pair));
    surface.periodic.push_back({patches[0], patches[1]});
  }
}

}  // namespace hfr::app

// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_LABELS_HH
#define HFR_APPS_LABELS_HH

#include <string>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/IO/MeshData.hh"
#include "hfremesh/Surface/SurfaceOptions.hh"

/// What the triangles, edges and labels of a file forbid a run to change, and how to go without.
namespace hfr::app {

/// One line where triangles of label 0 lie inside a region: they are kept like those that have a label.
std::vector<std::string> notes_on_inner_triangles(const TetMesh& mesh);

/// For --ignore-labels while the surface may change, or where there is nothing but a surface: takes triangles
/// beside cells, edges and labels out of `data`. Returns one line with their counts, where there are any.
std::vector<std::string> drop_labels(io::MeshData& data);
/// The same while the surface is frozen, where those on the boundary or between two regions forbid nothing
/// more: takes out what lies inside.
std::vector<std::string> drop_inner_labels(TetMesh& mesh);

/// What --fix names must be there; fails with exit code 1 otherwise.
void require_fixed(const SurfaceOptions& options, const TetMesh& mesh);
void require_fixed(const SurfaceOptions& options, const io::MeshData& surface);

}  // namespace hfr::app

#endif

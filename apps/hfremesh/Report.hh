// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_HH
#define HFR_APPS_REPORT_HH

#include <string>
#include <vector>

#include "hfremesh/IO/MeshData.hh"
#include "hfremesh/Quality/Statistics.hh"
#include "hfremesh/Remesh/Improve.hh"

/// Tables for humans, on stdout.
namespace hfr::app {

/// A column of the table of statistics.
struct Column {
  std::string heading;
  const Statistics* statistics;
};

/// One row a figure, one column a mesh.
void print_statistics(const std::vector<Column>& columns);
/// One row a pass.
void print_passes(const std::vector<PassReport>& passes);
/// How many cells are below an angle and why. Nothing where none are.
void print_limits(const Result& result);
/// One line: what became of a surface that might change.
void print_surface(const SurfaceReport& surface);
/// One line: the file and its counts.
void print_written(const std::string& path, const io::MeshData& data);
/// "3, 17, 20 and 5 more".
std::string id_list(const std::vector<CellHandle>& cells, std::size_t limit = 10);
/// 1234567 → "1,234,567".
std::string grouped(std::size_t n);

}  // namespace hfr::app

#endif

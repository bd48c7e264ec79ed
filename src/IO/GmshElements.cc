// SPDX-License-Identifier: BSD-3-Clause
// Numbers and node counts of "Low order elements" and "High-order elements" in the Gmsh manual.
#include "IO/GmshElements.hh"

#include <algorithm>
#include <array>
#include <span>

namespace hfr::io::gmsh {
namespace {

struct Row {
  int type;
  int nodes;
};

constexpr std::array<Row, 10> kLines = {
    {{1, 2}, {8, 3}, {26, 4}, {27, 5}, {28, 6}, {62, 7}, {63, 8}, {64, 9}, {65, 10}, {66, 11}}};
constexpr std::array<Row, 18> kTriangles = {{{2, 3},
                                             {9, 6},
                                             {20, 9},
                                             {21, 10},
                                             {22, 12},
                                             {23, 15},
                                             {24, 15},
                                             {25, 21},
                                             {42, 28},
                                             {43, 36},
                                             {44, 45},
                                             {45, 55},
                                             {46, 66},
                                             {52, 18},
                                             {53, 21},
                                             {54, 24},
                                             {55, 27},
                                             {56, 30}}};
constexpr std::array<Row, 19> kQuadrangles = {{{3, 4},
                                               {10, 9},
                                               {16, 8},
                                               {36, 16},
                                               {37, 25},
                                               {38, 36},
                                               {39, 12},
                                               {40, 16},
                                               {41, 20},
                                               {47, 49},
                                               {48, 64},
                                               {49, 81},
                                               {50, 100},
                                               {51, 121},
                                               {57, 24},
                                               {58, 28},
                                               {59, 32},
                                               {60, 36},
                                               {61, 40}}};
constexpr std::array<Row, 18> kTetrahedra = {{{4, 4},
                                              {11, 10},
                                              {29, 20},
                                              {30, 35},
                                              {31, 56},
                                              {32, 22},
                                              {33, 28},
                                              {71, 84},
                                              {72, 120},
                                              {73, 165},
                                              {74, 220},
                                              {75, 286},
                                              {79, 34},
                                              {80, 40},
                                              {81, 46},
                                              {82, 52},
                                              {83, 58},
                                              {137, 16}}};

int nodes_of(std::span<const Row> rows, int type) {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](Row r) { return r.type == type; });
  return row == rows.end() ? 0 : row->nodes;
}

bool is_hexahedron(int t) { return t == 5 || t == 12 || t == 17 || t == 88 || (t >= 92 && t <= 105); }
bool is_prism(int t) {
  return t == 6 || t == 13 || t == 18 || t == 89 || t == 90 || t == 91 || (t >= 106 && t <= 117);
}
bool is_pyramid(int t) { return t == 7 || t == 14 || t == 19 || (t >= 118 && t <= 132); }

}  // namespace

ElementType element_type(int type) {
  if (const int n = nodes_of(kTetrahedra, type)) return {"tetrahedra", 3, 4, n};
  if (const int n = nodes_of(kTriangles, type)) return {"triangles", 2, 3, n};
  if (const int n = nodes_of(kLines, type)) return {"lines", 1, 2, n};
  if (type == kPoint) return {"points", 0, 1, 1};
  if (const int n = nodes_of(kQuadrangles, type)) return {"quadrangles", 2, 4, n};
  if (is_hexahedron(type)) return {"hexahedra", 3, 8, 0};
  if (is_prism(type)) return {"prisms", 3, 6, 0};
  if (is_pyramid(type)) return {"pyramids", 3, 5, 0};
  if (type == 34) return {"polygons", 2, 0, 0};
  if (type == 35) return {"polyhedra", 3, 0, 0};
  return {};
}

}  // namespace hfr::io::gmsh

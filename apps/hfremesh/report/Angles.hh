// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_ANGLES_HH
#define HFR_APPS_REPORT_ANGLES_HH

#include <vector>

#include "Canvas.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::view {

/// Cells below this are coloured, as in Fig. 7 of D'Amato & Vénere (2013); degrees.
inline constexpr double kPoorBelow = 15;

/// The smallest dihedral of each cell in degrees, by its index; negative in an inverted cell, 0 in a flat
/// one. Precondition: nothing in the mesh is deleted.
std::vector<float> smallest_dihedrals(const TetMesh& mesh, par::Policy policy);

/// Inverted or flat: no solver can take such a cell.
inline bool is_invalid(float degrees) { return !(degrees > 0); }

// What is seen by those who tell red from green and those who do not: poor cells go from pale yellow to dark
// red, darker with every degree, on a surface of pale blue; invalid cells are violet.
inline constexpr Colour kSurfaceColour = hex(0xc3d0df);
inline constexpr Colour kInsideColour = hex(0xe9edf2);
inline constexpr Colour kInvalidColour = hex(0x6a00d8);
/// Of a cell below kPoorBelow.
Colour poor_colour(double degrees);
/// Those of poor and invalid cells, in the light and in the shade: few pixels may have them, and they matter.
std::vector<Colour> colours_that_matter();
/// Of any cell, on the surface or on a cut.
Colour cell_colour(double degrees, Colour others);

}  // namespace hfr::view

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_IN_PARTS_HH
#define HFR_DISTRIBUTED_IN_PARTS_HH

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hfremesh/Distributed/DistributedMesh.hh"
#include "hfremesh/Distributed/Partition.hh"
#include "hfremesh/Distributed/RankFigures.hh"
#include "hfremesh/HalfFace/Generate.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/Remesh/Improve.hh"

/// Meshes that are in parts from beginning to end: no rank ever holds the whole, or an array of its size
/// (docs/distributed.md says what goes to all ranks nevertheless). All ranks call each function at the same
/// time, with the same arguments; where one throws, the others throw RankFailed with their next call.
namespace hfr::mpi {

/// generate::cavity() between two corners; with an amplitude of 0 generate::jittered_box().
struct GridOptions {
  generate::CavityOptions cavity;
  Vec3 low = {0, 0, 0}, high = {1, 1, 1};
};
/// Makes the parts, each on its rank: the points, cells and numbers of the mesh that the function for shared
/// memory makes, which may have more cells here than an index can count. `how`: kNumbers are slices, all else
/// blocks. Throws InvalidInput for what that function refuses.
void generate_in_parts(DistributedMesh& mesh, const GridOptions& options,
                       Partition how = Partition::kCoordinates);

/// Degrees below which InParts counts cells.
inline constexpr std::array<double, 6> kCountedBelow = {5, 10, 15, 20, 25, 30};
/// What is known of the whole, the same on all ranks.
struct InParts {
  std::uint64_t n_vertices = 0, n_cells = 0, n_boundary_faces = 0;
  std::uint64_t n_invalid = 0;  ///< cells whose volume is not positive beyond rounding
  std::uint64_t n_below_goal = 0;
  std::array<std::uint64_t, kCountedBelow.size()> n_below{};  ///< by kCountedBelow
  double worst = 0;             ///< decision value of MinDihedral of the worst cell
  double min_dihedral = 0;      ///< the same in degrees
  std::uint64_t most_held = 0;  ///< cells that one rank holds, of others included; slots that are free, too
};
/// `goal`: degrees. O(part), and two reductions.
InParts survey(DistributedMesh& mesh, double goal = 0, par::Policy policy = {});

/// What improve() has done to a mesh in parts; the same on all ranks, but for seconds and figures.
struct PartsResult {
  InParts before, after;
  bool changed = false;
  bool goal_reached = false;
  Stop stop = Stop::kNoProgress;  ///< why the run has ended
  /// With polish_only: the input had positive cells, and the smallest angle is below its smallest one, for
  /// which hfr::improve() would have put the input back. Seen only where an obtuse angle was the worst.
  bool has_fallen = false;
  SurfaceReport surface;  ///< without regions
  std::vector<PassReport> passes;
  double seconds = 0;
  RankFigures mine;  ///< of this rank: rounds, and its part at the end; see gather_figures()
};
/// What of these options is not there in parts, as in "meshes in parts do not have …"; empty where all is.
std::string reason_against(const ImproveOptions& options);
/// hfr::improve(): the same bits, for each number of ranks and threads. Where cells of a run without a goal
/// are scattered in memory, they are numbered anew first, as there.
///
/// Where the surface may change, each rank holds all of it, and is told of all that happens to it.
///
/// Candidates for new vertices and searched clusters come together on rank 0, some 300 bytes each, and on all
/// ranks the surroundings of the last few cells, up to 32 patches. Unless it polishes a mesh of positive
/// cells alone (options.polish_only) that touches itself nowhere, each rank keeps copies of its part to go
/// back to; where the mesh has invalid cells, or a boundary that lies on itself, rank 0 selects the winners
/// of rounds, and where it has pinched vertices, those of rounds with a candidate that has two of them.
/// Throws InvalidInput for what reason_against() names: another metric than volume-length for all cells,
/// periodic patches, published pipelines, devices, maps, other smoothers; where the mesh lacks what
/// options.surface names as fixed, by the numbers of the whole; and for coordinates that hfr::improve()
/// refuses.
///
/// Towards a goal, ranks may own vertices of others while it runs (docs/distributed.md, "Damage in one
/// place"); whose they were is as before afterwards, but handles of a part's vertices may be others.
///
/// Ranks may have other time limits and callbacks: all stop where one of them is to, and hear of the same
/// progress. A limit costs a reduction for each round. A rank whose callback throws has to call Comm::fail(),
/// as for any other failure; the mesh is of no further use then.
///
/// `renumbered`: gets, where the run gave cells other numbers first, those of each cell that this rank held
/// then, before and after; by ascending ones before.
PartsResult improve(DistributedMesh& mesh, const ImproveOptions& options,
                    std::vector<std::pair<std::uint64_t, std::uint64_t>>* renumbered = nullptr);

/// What check() of the parts has found.
struct PartsCheck {
  bool is_good = true;
  int rank = 0;         ///< the first that found something
  std::string message;  ///< one line; empty where nothing is wrong; that of that rank, on all
};
/// Where the mesh touches itself, as far as this rank's own vertices go.
struct Pinches {
  /// By number: into how many groups the cells of a vertex fall that connect through faces of it.
  std::map<std::uint64_t, std::size_t> vertices;
  /// By the numbers of an own vertex and of the other end: how many fans of cells an edge has.
  std::map<std::array<std::uint64_t, 2>, std::size_t> edges;
};
Pinches pinches(const DistributedMesh& mesh);

/// Each rank looks at its own cells and vertices by the rules of hfr::check(), orientation and manifold edges
/// and vertices included; then cells and vertices that are held for others are compared with their owners',
/// to the last bit, and faces of the boundary with those of all ranks, since none may be another's mate.
/// `known`: what was there before, which counts as a fault where there are more groups or fans now.
PartsCheck check(DistributedMesh& mesh, const Pinches& known = {});
/// The same since the mesh was `before`, its copy() on each rank: looks at cells that were others then or not
/// there, their vertices and their neighbours, and at vertices that had another incident cell or number of
/// cells. A rank knows what it held then by its numbers. Pinches that were there before are no fault.
PartsCheck check_changes(DistributedMesh& mesh, const DistributedMesh& before);

/// `path`, an index of pieces (.pvtu), and beside it, in a folder of its name, one piece (.vtu, raw appended)
/// for each rank: its own cells and all their points, each with its "number" in the whole. Numbers have no
/// gaps: they are those of the mesh after hfr::improve(). The index is written last; every file is whole or
/// not there.
void write_pvtu(DistributedMesh& mesh, const std::filesystem::path& path);
/// The file of a rank: its piece of a .pvtu, in the folder beside that; otherwise "name.7.mesh" for
/// "name.mesh", as write_medit_parts() calls it.
std::filesystem::path part_path(const std::filesystem::path& path, int rank);
/// write_ranges() to a path that ends in .vtu.
void write_vtu(DistributedMesh& mesh, const std::filesystem::path& path);
/// One .vtu, .mesh, .meshb or .msh with the bytes that io::write() writes of the whole, for each number of
/// ranks; of arrays that were read, in .vtu alone. Each rank writes a range of the numbers of points and
/// elements, which is sent to it before, at its place in one temporary file, which is renamed in the end: all
/// ranks see one file system. What stands in text is formatted twice, a megabyte at a time: to know how long
/// it is, and to write it. Returns one line for each thing that the format cannot hold, the same on all
/// ranks. Throws InvalidInput for other formats and for variants that there are not (of .vtu, "appended"
/// alone is there), IoError where the file cannot be written.
std::vector<std::string> write_ranges(DistributedMesh& mesh, const std::filesystem::path& path,
                                      const io::WriteOptions& options = {});

/// What write_pvtu() has written, by any number of ranks: piece i is read by rank i mod n, and points that
/// several ranks have belong to the one with most of their cells; parts are cut anew where these are uneven,
/// as when there are more ranks than pieces. Throws InvalidInput where pieces have no "number", numbers have
/// gaps, or there are other elements than tetrahedra, triangles and edges; IoError where a file is missing.
/// Labels, names and fixed vertices come along, and the arrays that all pieces have, attached as
/// hfr::improve() has fields: a vertex keeps its values wherever it goes. Of the copies of a point those of
/// the first piece count. Returns one line for each thing that is left out: arrays that not all pieces have,
/// on all ranks, and others of the pieces that this rank has read.
std::vector<std::string> read_pvtu(DistributedMesh& mesh, const std::filesystem::path& path);
/// One file, of which each rank reads a range of the points and one of the elements, and none the whole: .vtu
/// whose arrays are raw appended data, as write_vtu() and io::write() make it; .mesh, .meshb, and .msh as
/// text of version 2.2 or 4.1, with each entry on a line of its own. Points and elements have the numbers,
/// and labels the order, that io::read() gives them. Labels, names and fixed vertices come along; so do the
/// other arrays of numbers of a .vtu, attached as by read_pvtu(). What is left out is named in what is
/// returned, on all ranks. Throws InvalidInput for other elements
/// than tetrahedra, triangles and edges, for files of another form, and for triangles and edges of no
/// tetrahedron; IoError where the file cannot be read. `at_once`: elements that a rank reads and sends away
/// before it reads on, about.
std::vector<std::string> read_ranges(DistributedMesh& mesh, const std::filesystem::path& path,
                                     std::uint64_t at_once = 250'000);

/// What read_pvtu() and read_ranges() have attached to points: names of arrays, and how many vertices have
/// the values of another place, since they were moved with them, or are new with those of the nearest. The
/// same on all ranks.
struct AttachedToPoints {
  std::vector<std::string> names;
  std::uint64_t n_elsewhere = 0;
};
AttachedToPoints attached_to_points(DistributedMesh& mesh);

/// The files of ParMmg for a mesh in parts, "name.0.mesh", "name.1.mesh", … for the path "name.mesh": text in
/// Medit's format that says which triangles or vertices a part shares with others. Any number of them; file i
/// is read by rank i mod n. Vertices, cells, triangles and edges have the order of the files; of the copies
/// of a vertex that of the smallest part counts. What has no label and is there since parts meet is left out:
/// triangles of communicators, or, where those are of vertices, triangles all of whose vertices two parts
/// share, and edges that are listed as parallel. What is listed as parallel and required is not fixed. Throws
/// IoError where a file cannot be opened, InvalidInput where one is broken or cut short, and where sides of
/// an interface do not agree. Returns notes on the files that this rank has read.
std::vector<std::string> read_medit_parts(DistributedMesh& mesh, const std::filesystem::path& path);
/// Whether there are such files for the path, and no file of the path itself. All take part.
bool has_medit_parts(Comm& comm, const std::filesystem::path& path);
/// Such files, one for each rank, with communicators of triangles. All are renamed when all are written.
/// Returns one line for each thing that the format cannot hold. Throws InvalidInput where a rank has no
/// cells, and for more vertices or cells than 32 bits count; IoError where a file cannot be written.
std::vector<std::string> write_medit_parts(DistributedMesh& mesh, const std::filesystem::path& path);

}  // namespace hfr::mpi

#endif

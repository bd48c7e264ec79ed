// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_APPS_TOOL_HH
#define HFR_UNITTESTS_APPS_TOOL_HH

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace hfr::app::test {

/// What a run of the program left behind.
struct Outcome {
  int code = -1;  ///< exit code; 128 + N when signal N ended the process
  std::string out;
  std::string err;
};

/// A fresh folder that goes with the test, and the program run inside it with nothing on its standard input.
class Tool {
 public:
  Tool();
  ~Tool();
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  /// Runs hfremesh with these arguments, split at spaces.
  Outcome run(const std::string& arguments);
  /// Runs a shell command with the program's path in $TOOL.
  Outcome shell(const std::string& command);

  /// Ends every program started from now on by SIGALRM when it runs this long: for tests that look for hangs.
  void limit_seconds(unsigned seconds) { limit_seconds_ = seconds; }

  /// Starts the program; wait for it with finish().
  pid_t start(const std::string& arguments);
  Outcome finish(pid_t child);
  /// What it has written to its standard error so far.
  std::string err_so_far() const { return content(".err"); }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const;
  std::string content(const std::string& name) const;
  /// Names in the folder, sorted, without those of the captured streams.
  std::vector<std::string> files() const;

 private:
  pid_t spawn(const std::vector<std::string>& words);

  std::filesystem::path folder_;
  unsigned limit_seconds_ = 0;  // 0: none
};

/// ASCII .mesh files of 5 vertices and 2 cells on a common face.
inline constexpr const char* kTwoCells =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 -1 0\n"
    "Tetrahedra\n2\n1 2 3 4 0\n1 3 2 5 0\nEnd\n";
/// The same with the last vertex inside the first cell: the second cell is inverted, but three cells round a
/// new edge would fill what the surface encloses.
inline constexpr const char* kFoldedCells =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0.2 0.2 0.1 0\n"
    "Tetrahedra\n2\n1 2 3 4 0\n1 3 2 5 0\nEnd\n";
/// The same with the last vertex above the common face and outside: the surface crosses itself, and as it may
/// not change, nothing can be done.
inline constexpr const char* kHopelessCells =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n2 2 0.5 0\n"
    "Tetrahedra\n2\n1 2 3 4 0\n1 3 2 5 0\nEnd\n";
/// kFoldedCells with the second cell renumbered so that its volume looks positive.
inline constexpr const char* kRenumberedCells =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0.2 0.2 0.1 0\n"
    "Tetrahedra\n2\n1 2 3 4 0\n1 2 3 5 0\nEnd\n";
/// kTwoCells in the other order as a whole.
inline constexpr const char* kFlippedCells =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 -1 0\n"
    "Tetrahedra\n2\n1 3 2 4 0\n1 2 3 5 0\nEnd\n";

}  // namespace hfr::app::test

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_PRESENTATION_HH
#define HFR_APPS_PRESENTATION_HH

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ExitCode.hh"
#include "Parser.hh"
#include "hfremesh/Remesh/Improve.hh"

namespace hfr {
class TetMesh;
}

/// Pictures and pages that are made of a mesh before and after: --png and --report.
namespace hfr::app {

struct PresentationFiles {
  std::string png, page;  ///< empty for none; "-" is stdout
  int png_width = 1600;   ///< pixels

  bool any() const { return !png.empty() || !page.empty(); }
};

/// --png, and the page under the name `page_names`.
void add_presentation_options(Command command, PresentationFiles& files, const std::string& page_names);

/// Fails where one of the files cannot be written, or the build cannot make it.
void require_presentable(const PresentationFiles& files);

/// Gathers what the files need while the mesh is at hand. Does nothing where there are none.
class Presentation {
 public:
  /// The names are those of the meshes in the pictures.
  Presentation(PresentationFiles files, const std::string& before, const std::string& after,
               par::Policy policy);
  ~Presentation();
  Presentation(const Presentation&) = delete;
  Presentation& operator=(const Presentation&) = delete;

  void add_before(const TetMesh& mesh);
  /// Whether it wants to know how a run goes on, by note().
  bool watches() const { return !files_.page.empty(); }
  void note(const Progress& progress);
  /// `result`: of the run that made it, null where that is not known.
  void add_after(const TetMesh& mesh, const Result* result);

  /// Writes the files. `report` has "before" and "after", as to_json() gives these statistics. Returns the
  /// code to end with, see save_report().
  ExitCode save(const Statistics& before, const Statistics& after, const nlohmann::ordered_json& report,
                ExitCode code) const;

 private:
  struct Parts;

  PresentationFiles files_;
  std::string before_, after_;
  par::Policy policy_;
  std::unique_ptr<Parts> parts_;
};

}  // namespace hfr::app

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "Presentation.hh"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "Console.hh"
#include "Files.hh"
#include "Memory.hh"
#include "Numbers.hh"
#include "Options.hh"
#include "Paths.hh"
#include "report/Angles.hh"
#include "report/Page.hh"
#include "report/Picture.hh"
#include "report/Png.hh"

namespace hfr::app {
namespace {

constexpr std::size_t kMostCells = 100;  // of those that are listed one by one: of each reason, or of all

/// What pictures call a mesh.
std::string shown_name(const std::string& path) {
  if (path == "-") return "a stream";
  return std::filesystem::path(path).filename().string();
}

}  // namespace

struct Presentation::Parts {
  Stopwatch watch;
  std::optional<view::Picture> picture;
  view::PageMesh before, after;
  std::vector<view::Moment> moments;
};

void add_presentation_options(Command command, PresentationFiles& files, const std::string& page_names) {
  command
      .option(page_names, files.page,
              "Write a page about the meshes before and after, with views of both, as one HTML file")
      .type_name("FILE")
      .transform(stream_name());
  command
      .option("--png", files.png,
              "Write a picture: before and after side by side, cut open, with histograms of the angles")
      .type_name("FILE")
      .transform(stream_name());
  command.option("--png-width", files.png_width, "Width of the picture in pixels; 1600 by default")
      .type_name("N")
      .check(whole_number(400, 10000));
}

void require_presentable(const PresentationFiles& files) {
  if (!files.png.empty() && !view::has_png())
    throw Failure(ExitCode::kUsage, "--png: this build has no libpng; --report works without it");
  if (!files.png.empty()) require_writable(files.png);
  // Three layers of nine samples a pixel, of 20 bytes each, for a panel of about a sixth of the picture.
  constexpr double kBytesOfPixel = 100;
  const double width = files.png_width;
  if (!files.png.empty())
    require_memory(kBytesOfPixel * width * width, fmt::format("--png-width {}", files.png_width));
  if (!files.page.empty()) require_writable(files.page);
}

Presentation::Presentation(PresentationFiles files, const std::string& before, const std::string& after,
                           par::Policy policy)
    : files_(std::move(files)),
      before_(shown_name(before)),
      after_(shown_name(after.empty() ? before : after)),
      policy_(policy),
      parts_(std::make_unique<Parts>()) {}

Presentation::~Presentation() = default;

void Presentation::add_before(const TetMesh& mesh) {
  if (!files_.png.empty()) parts_->picture.emplace(mesh, before_, files_.png_width, policy_);
  if (!files_.page.empty()) {
    const std::vector<float> degrees = view::smallest_dihedrals(mesh, policy_);
    parts_->before = {before_, view::pack(mesh, degrees, {}), view::worst_cells(mesh, degrees, kMostCells)};
  }
  parts_->watch = Stopwatch();  // what follows is the run
}

void Presentation::note(const Progress& progress) {
  if (!watches()) return;
  parts_->moments.push_back({parts_->watch.seconds(), progress.stage, progress.iteration,
                             progress.min_dihedral, progress.n_inverted});
}

void Presentation::add_after(const TetMesh& mesh, const Result* result) {
  if (!files_.png.empty()) parts_->picture->add_after(mesh, after_, policy_);
  if (files_.page.empty()) return;
  const std::vector<float> degrees = view::smallest_dihedrals(mesh, policy_);
  const bool explained = result != nullptr && !result->stuck.empty();
  parts_->after.name = after_;
  parts_->after.packed =
      view::pack(mesh, degrees, explained ? view::reasons_of(mesh, *result) : std::vector<std::uint8_t>());
  parts_->after.cells =
      explained ? view::stuck_cells(mesh, *result, kMostCells) : view::worst_cells(mesh, degrees, kMostCells);
}

ExitCode Presentation::save(const Statistics& before, const Statistics& after,
                            const nlohmann::ordered_json& report, ExitCode code) const {
  if (!files_.png.empty())
    code = save_report(
        files_.png,
        [&] { return view::png_of(parts_->picture->finish(before, after), view::colours_that_matter()); },
        code);
  if (!files_.page.empty())
    code = save_report(
        files_.page, [&] { return view::page_of(report, parts_->moments, parts_->before, parts_->after); },
        code);
  return code;
}

}  // namespace hfr::app

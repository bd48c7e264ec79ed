// SPDX-License-Identifier: BSD-3-Clause
#include "WriteMesh.hh"

#include <nlohmann/json.hpp>
#include <utility>

#include "Console.hh"
#include "Files.hh"
#include "Paths.hh"
#include "Report.hh"

namespace hfr::app {

ExitCode write_mesh(const std::string& path, const io::MeshData& data, const io::WriteOptions& options,
                    std::vector<std::string> notes, const CommonOptions& common, Json& report) {
  const Stopwatch write;
  for (std::string& note : notes_on_replacing(path)) notes.push_back(std::move(note));
  for (std::string& note : save(path, data, options)) notes.push_back(std::move(note));
  report["seconds"]["write"] = write.seconds();
  report["output"].update(contents(data));
  report["notes"] = notes;
  if (!common.quiet) print_notes(notes);
  if (common.prints_table()) print_written(path, data);
  return ExitCode::kDone;
}

}  // namespace hfr::app

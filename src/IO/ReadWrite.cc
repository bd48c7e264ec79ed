// SPDX-License-Identifier: BSD-3-Clause
#include "IO/ReadWrite.hh"

#include "IO/Assemble.hh"

namespace hfr::io {

TetMesh read(const std::filesystem::path& path, par::Policy policy, ReadReport* report) {
  MeshData data = read_mesh(path);
  HFR_REQUIRE(!data.cells.empty(), path.string() + ": there are no tetrahedra in the file");
  ReadReport told;
  told.notes = std::move(data.notes);
  TetMesh mesh;
  try {
    mesh = assemble(std::move(data), policy, &told.build, &told.notes);
  } catch (const InvalidInput& error) {  // the kernel does not know the file
    throw InvalidInput(path.string() + ": " + error.what());
  }
  if (report) *report = std::move(told);
  return mesh;
}

std::vector<std::string> write(const std::filesystem::path& path, const TetMesh& mesh,
                               const WriteOptions& options, par::Policy policy) {
  return write_mesh(path, disassemble(mesh, policy), options);
}

}  // namespace hfr::io

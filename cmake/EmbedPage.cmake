# SPDX-License-Identifier: BSD-3-Clause
# cmake -D FOLDER=apps/hfremesh/report -D FILES=report.html,report.js -D OUTPUT=file.cc -P EmbedPage.cmake
# Writes a C++ source that holds the files as byte lists.
set(lists "")
set(table "")
set(number 0)
string(REPLACE "," ";" files "${FILES}")
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(APPEND lists "constexpr unsigned char kBytes${number}[] = {${bytes}0};\n")
  string(APPEND table
    "  if (name == \"${file}\")\n    return {reinterpret_cast<const char*>(kBytes${number}), sizeof kBytes${number} - 1};\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT} "#include \"PageFiles.hh\"\n\n#include <string>\n\n#include \"hfremesh/HalfFace/Errors.hh\"\n\n"
  "namespace hfr::view {\nnamespace {\n${lists}}  // namespace\n\nstd::string_view page_file(std::string_view name) {\n"
  "${table}  throw InternalError(\"no page file \" + std::string(name));\n}\n\n}  // namespace hfr::view\n")

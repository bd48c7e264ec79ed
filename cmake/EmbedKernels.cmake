# SPDX-License-Identifier: BSD-3-Clause
# cmake -D FOLDER=kernels -D FILES=a.h,b.cl -D OUTPUT=file.cc -P EmbedKernels.cmake
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
    "    {\"${file}\", reinterpret_cast<const char*>(kBytes${number}), sizeof kBytes${number} - 1},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT} "#include \"Device/KernelFiles.hh\"\n\nnamespace hfr::detail {\nnamespace {\n${lists}\n"
  "const KernelFile kFiles[] = {\n${table}};\n}  // namespace\n\n"
  "std::span<const KernelFile> kernel_files() { return kFiles; }\n\n}  // namespace hfr::detail\n")

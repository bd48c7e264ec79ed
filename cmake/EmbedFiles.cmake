# SPDX-License-Identifier: BSD-3-Clause
# cmake -D FOLDER=kernels -D FILES=a.h,b.cl -D OUTPUT=file.cc -D HEADER=Device/KernelFiles.hh
#   -D NAMESPACE=hfr::detail -D TYPE=KernelFile -D FUNCTION=kernel_files -P EmbedFiles.cmake
# Writes a C++ source that holds the files as byte lists. The header declares struct TYPE {const char* name;
# const char* text; std::size_t size;} and std::span<const TYPE> FUNCTION().
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
file(WRITE ${OUTPUT} "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\nnamespace {\n${lists}\n"
  "const ${TYPE} kFiles[] = {\n${table}};\n}  // namespace\n\n"
  "std::span<const ${TYPE}> ${FUNCTION}() { return kFiles; }\n\n}  // namespace ${NAMESPACE}\n")

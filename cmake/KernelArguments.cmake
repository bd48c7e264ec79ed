# SPDX-License-Identifier: BSD-3-Clause
# cmake -D FOLDER=kernels -D FILES=a.h,b.cl -D OUTPUT=file.hh -P KernelArguments.cmake
# Writes a C++ header with one struct for each kernel: its plain arguments are members, its arrays those of a
# struct Arrays, which can be made from anything that has arrays of these names. So the host names what it
# passes: an argument that is missing, of another type, or const where the kernel writes does not compile, and
# none can take the place of another. Arguments are what the kernels have: __global pointers and plain values,
# or a macro ..._ARGUMENTS that stands for some; kernels that a macro ..._KERNEL(name, ...) makes are known by
# its uses.
string(REPLACE "," ";" files "${FILES}")
set(code "")
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} text)
  string(APPEND code "${text}\n")
endforeach()
string(REPLACE ";" " " code "${code}")
string(REGEX REPLACE "//[^\n]*" "" code "${code}")
string(REPLACE "\\\n" " " code "${code}")
string(REGEX REPLACE "[ \t]+" " " code "${code}")

string(REGEX MATCHALL "#define [A-Z_]+_ARGUMENTS [^\n]+" macros "${code}")
foreach(macro IN LISTS macros)
  string(REGEX MATCH "#define ([A-Z_]+) ([^\n]+)" unused "${macro}")
  set(name ${CMAKE_MATCH_1})
  set(arguments "${CMAKE_MATCH_2}")
  string(REPLACE "${name})" "${arguments})" code "${code}")
endforeach()

# kernels: their names; arguments_NAME: what stands between the parentheses.
set(kernels "")
string(REGEX MATCHALL "#define [A-Z_]+_KERNEL\\(name,[^)]*\\) KERNEL void name\\([^)]*\\)" macros "${code}")
foreach(macro IN LISTS macros)
  string(REGEX MATCH "#define ([A-Z_]+)\\(.*KERNEL void name\\(([^)]*)\\)" unused "${macro}")
  set(maker ${CMAKE_MATCH_1})
  set(arguments "${CMAKE_MATCH_2}")
  string(REGEX MATCHALL "\n${maker}\\([a-z_]+," uses "${code}")
  foreach(use IN LISTS uses)
    string(REGEX REPLACE "\n.*\\(([a-z_]+)," "\\1" kernel "${use}")
    list(APPEND kernels ${kernel})
    set(arguments_${kernel} "${arguments}")
  endforeach()
endforeach()
string(REGEX MATCHALL "\nKERNEL void [a-z_]+\\([^)]*\\)" plain "${code}")
foreach(one IN LISTS plain)
  string(REGEX MATCH "KERNEL void ([a-z_]+)\\(([^)]*)\\)" unused "${one}")
  list(APPEND kernels ${CMAKE_MATCH_1})
  set(arguments_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
endforeach()
list(SORT kernels)

set(host_cell_t cl_uint)  # eight a cell
set(host_uint cl_uint)
set(host_uchar cl_uchar)
set(host_ulong cl_ulong)
set(host_int cl_int)
set(host_double double)
set(structs "")
foreach(kernel IN LISTS kernels)
  set(values "")
  set(arrays "")
  set(from "")
  set(names "")
  set(calls "")
  string(REGEX REPLACE "[ \n]+" " " arguments "${arguments_${kernel}}")
  string(REPLACE "," ";" arguments "${arguments}")
  foreach(argument IN LISTS arguments)
    string(STRIP "${argument}" argument)
    string(REGEX MATCH "^(__global )?(const )?([a-z_]+) ?(\\*?) ?([a-z_]+)$" found "${argument}")
    if(NOT found OR NOT DEFINED host_${CMAKE_MATCH_3})
      message(FATAL_ERROR "kernel ${kernel}: unknown argument '${argument}'")
    endif()
    set(name ${CMAKE_MATCH_5})
    if(CMAKE_MATCH_4)
      string(APPEND arrays "    ${CMAKE_MATCH_2}DeviceArray<${host_${CMAKE_MATCH_3}}>& ${name};\n")
      list(APPEND from "all.${name}")
      list(APPEND calls "set(arrays.${name})")
    else()
      string(APPEND values "  KernelValue<${host_${CMAKE_MATCH_3}}> ${name};\n")
      list(APPEND calls "set(${name})")
    endif()
    list(APPEND names "\"${name}\"")
  endforeach()
  list(JOIN names ", " names)
  list(JOIN calls ", " calls)
  list(JOIN from ", " from)
  string(APPEND structs "struct ${kernel} {\n  static constexpr const char* kName = \"${kernel}\";\n"
    "  static constexpr std::array kArguments = {${names}};\n${values}  struct Arrays {\n${arrays}"
    "    template <class All>\n    static Arrays from(All& all) {\n      return {${from}};\n    }\n  };\n"
    "  template <class Set>\n  void for_each(const Arrays& arrays, Set&& set) const {\n    ${calls};\n  }\n};\n")
endforeach()
list(JOIN kernels ", " all)
file(WRITE ${OUTPUT} "// Made of kernels/*.cl by cmake/KernelArguments.cmake.\n#ifndef HFR_DEVICE_KERNEL_ARGUMENTS_HH\n"
  "#define HFR_DEVICE_KERNEL_ARGUMENTS_HH\n\n#include <array>\n\n#include \"Device/DeviceArray.hh\"\n\n"
  "namespace hfr::detail::kernel {\n\n${structs}\nusing All = KernelList<${all}>;\n\n"
  "}  // namespace hfr::detail::kernel\n\n#endif\n")

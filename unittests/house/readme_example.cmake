# SPDX-License-Identifier: BSD-3-Clause
# The README shows examples/readme_example.cc, which is compiled and run, letter for letter (without its licence
# line). Run with -DWRITE=ON to put the example's present text into the README.
file(READ ${README} readme)
file(READ ${EXAMPLE} example)
string(REGEX REPLACE "^// SPDX[^\n]*\n" "" example "${example}")

set(begin "<!-- examples/readme_example.cc -->\n```cpp\n")
set(end "```\n<!-- end of example -->")
string(FIND "${readme}" "${begin}" begin_at)
string(FIND "${readme}" "${end}" end_at)
if(begin_at LESS 0 OR end_at LESS begin_at)
  message(FATAL_ERROR "${README} has no block between the markers of examples/readme_example.cc")
endif()
string(LENGTH "${begin}" begin_length)
math(EXPR code_at "${begin_at} + ${begin_length}")
math(EXPR code_length "${end_at} - ${code_at}")
string(SUBSTRING "${readme}" ${code_at} ${code_length} shown)

if(WRITE)
  string(SUBSTRING "${readme}" 0 ${code_at} head)
  string(SUBSTRING "${readme}" ${end_at} -1 tail)
  file(WRITE ${README} "${head}${example}${tail}")
elseif(NOT shown STREQUAL example)
  message(FATAL_ERROR "README.md no longer shows examples/readme_example.cc; bring it up to date with "
    "cmake -DWRITE=ON -DREADME=README.md -DEXAMPLE=examples/readme_example.cc "
    "-P unittests/house/readme_example.cmake")
endif()

# SPDX-License-Identifier: BSD-3-Clause
# Every installed header in one translation unit: none may include a header that was left behind, and no two may
# contradict each other.
string(APPEND WORK /headers)
include(${CMAKE_CURRENT_LIST_DIR}/pkg_config_flags.cmake)
hfr_pkg_config(root --variable=includedir)
file(GLOB_RECURSE headers RELATIVE ${root} ${root}/*)
list(REMOVE_ITEM headers hfremesh.h)  # for C
# Those of several ranks need MPI: consumer_mpi includes them.
list(FILTER headers EXCLUDE REGEX "^hfremesh/Distributed/")
list(LENGTH headers n_headers)
if(n_headers LESS 20)
  message(FATAL_ERROR "only ${n_headers} headers below ${root}")
endif()
# What is public is chosen (HEADERS of hfr_layer); a header more is one more to keep as it is.
if(n_headers GREATER 70)
  message(FATAL_ERROR "${n_headers} headers are installed, 70 at most are to be")
endif()
message(STATUS "${n_headers} headers")
# All below the one folder that carries our name.
set(outside ${headers})
list(FILTER outside EXCLUDE REGEX "^hfremesh/[A-Za-z]+/[A-Za-z0-9_]+\\.hh?$")
if(outside)
  message(FATAL_ERROR "installed, and no header below ${root}/hfremesh: ${outside}")
endif()
if(EIGEN)
  list(APPEND FLAGS -isystem ${EIGEN})
else()
  list(FILTER headers EXCLUDE REGEX "/Eigen[A-Za-z]*\\.hh$")
endif()
list(TRANSFORM headers REPLACE ".+" "#include <\\0>")
list(JOIN headers "\n" text)
file(WRITE ${WORK}/all.cc "${text}\nint main() {}\n")
hfr_pkg_config(flags --cflags)
execute_process(COMMAND ${COMPILER} -std=c++20 -Wall -Wextra -Werror -fsyntax-only ${FLAGS} ${flags} ${WORK}/all.cc
  COMMAND_ERROR_IS_FATAL ANY)

# SPDX-License-Identifier: BSD-3-Clause
# PTScotch::PTScotch, the partitioner on several ranks. Installed with the package, too: whoever links a static
# hfremesh::mpi has to find it.
find_path(PTSCOTCH_INCLUDE_DIR NAMES ptscotch.h PATH_SUFFIXES scotch)
set(hfr_ptscotch_libraries "")
foreach(library IN ITEMS ptscotch scotch ptscotcherr)
  string(TOUPPER ${library}_LIBRARY variable)
  find_library(${variable} NAMES ${library})
  mark_as_advanced(${variable})
  list(APPEND hfr_ptscotch_libraries ${variable})
endforeach()
mark_as_advanced(PTSCOTCH_INCLUDE_DIR)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PTScotch REQUIRED_VARS ${hfr_ptscotch_libraries} PTSCOTCH_INCLUDE_DIR)
if(PTScotch_FOUND AND NOT TARGET PTScotch::PTScotch)
  add_library(PTScotch::PTScotch INTERFACE IMPORTED)
  target_include_directories(PTScotch::PTScotch SYSTEM INTERFACE ${PTSCOTCH_INCLUDE_DIR})
  target_link_libraries(PTScotch::PTScotch INTERFACE ${PTSCOTCH_LIBRARY} ${SCOTCH_LIBRARY} ${PTSCOTCHERR_LIBRARY})
endif()

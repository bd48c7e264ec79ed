# SPDX-License-Identifier: BSD-3-Clause
# Install rules: the library (its headers: HfrLayer.cmake), the CMake package, the pkg-config file and
# the tool. All of it may be moved as a whole after installing.
include(CMakePackageConfigHelpers)

set(hfr_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hfremesh)

install(TARGETS hfremesh EXPORT hfremeshTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT lib NAMELINK_COMPONENT dev)
install(EXPORT hfremeshTargets NAMESPACE hfremesh:: DESTINATION ${hfr_package_dir})
if(TARGET hfremesh_tool)
  install(TARGETS hfremesh_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tool)
endif()
if(TARGET hfremesh_manual)
  set(hfr_manual ${PROJECT_BINARY_DIR}/apps/hfremesh/manual)
  install(FILES ${hfr_manual}/hfremesh.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tool)
  install(FILES ${hfr_manual}/hfremesh DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    COMPONENT tool)
  install(FILES ${hfr_manual}/_hfremesh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT tool)
  install(FILES ${hfr_manual}/hfremesh.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
    COMPONENT tool)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/hfremesh)

# A shared library brings its own dependencies along; whoever links a static one has to find them.
set(HFR_FIND_DEPENDENCIES "")
set(HFR_PC_REQUIRES_PRIVATE "")
set(HFR_PC_LIBS_PRIVATE "")
get_target_property(hfr_library_type hfremesh TYPE)
if(hfr_library_type STREQUAL "STATIC_LIBRARY")
  get_property(hfr_private_libraries GLOBAL PROPERTY HFR_PRIVATE_LIBRARIES)
  list(REMOVE_DUPLICATES hfr_private_libraries)
  foreach(library IN LISTS hfr_private_libraries)
    if(library STREQUAL "ZLIB::ZLIB")
      list(APPEND HFR_FIND_DEPENDENCIES "find_dependency(ZLIB)")
      list(APPEND HFR_PC_REQUIRES_PRIVATE zlib)
    elseif(library STREQUAL "tinyxml2::tinyxml2")
      list(APPEND HFR_FIND_DEPENDENCIES "find_dependency(tinyxml2)")
      list(APPEND HFR_PC_REQUIRES_PRIVATE tinyxml2)
    elseif(library STREQUAL "fmt::fmt")
      list(APPEND HFR_FIND_DEPENDENCIES "find_dependency(fmt)")
      list(APPEND HFR_PC_REQUIRES_PRIVATE fmt)
    elseif(library STREQUAL "OpenMP::OpenMP_CXX")
      list(APPEND HFR_FIND_DEPENDENCIES "find_dependency(OpenMP COMPONENTS CXX)")
      list(APPEND HFR_PC_LIBS_PRIVATE ${OpenMP_CXX_FLAGS})
    elseif(library STREQUAL "TBB::tbb")
      list(APPEND HFR_FIND_DEPENDENCIES "find_dependency(TBB)")
      list(APPEND HFR_PC_REQUIRES_PRIVATE tbb)
    elseif(library STREQUAL "dl")
      list(APPEND HFR_PC_LIBS_PRIVATE -ldl)
    elseif(library MATCHES "^OpenMesh(Core|Tools)$")
      list(APPEND HFR_FIND_DEPENDENCIES "find_dependency(OpenMesh)")
      list(APPEND HFR_PC_LIBS_PRIVATE -l${library})
    elseif(NOT library STREQUAL "Eigen3::Eigen")  # header only, and in no header of ours
      message(FATAL_ERROR "HfrInstall.cmake does not know how users of a static library find ${library}")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES HFR_FIND_DEPENDENCIES)
endif()
list(JOIN HFR_FIND_DEPENDENCIES "\n" HFR_FIND_DEPENDENCIES)
list(JOIN HFR_PC_REQUIRES_PRIVATE " " HFR_PC_REQUIRES_PRIVATE)
list(JOIN HFR_PC_LIBS_PRIVATE " " HFR_PC_LIBS_PRIVATE)
list(JOIN HFR_PUBLIC_OPTIONS " " HFR_PC_CFLAGS)
file(RELATIVE_PATH HFR_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH HFR_PC_LIBDIR ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH HFR_PC_INCLUDEDIR ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_INCLUDEDIR})

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/hfremeshConfig.cmake.in
  ${PROJECT_BINARY_DIR}/hfremeshConfig.cmake INSTALL_DESTINATION ${hfr_package_dir}
  NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/hfremeshConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hfremeshConfig.cmake ${PROJECT_BINARY_DIR}/hfremeshConfigVersion.cmake
  DESTINATION ${hfr_package_dir})

configure_file(${PROJECT_SOURCE_DIR}/cmake/hfremesh.pc.in ${PROJECT_BINARY_DIR}/hfremesh.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/hfremesh.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

if(PROJECT_IS_TOP_LEVEL)
  include(HfrPackages)
endif()

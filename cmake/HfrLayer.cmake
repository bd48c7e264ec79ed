# SPDX-License-Identifier: BSD-3-Clause
# A layer is one folder below src/. Layers depend on those before them in this list and on no other, so each
# is an object library of its own that tests can link without what stands above it.
set(HFR_LAYERS Parallel HalfFace Quality IO Transfer Operators Surface Scheduler Device Remesh)

# Where users find the headers: they include <hfremesh/LAYER/NAME.hh>, so that no folder of ours (IO, Device) lands
# in anybody's include path.
set(HFR_INCLUDE_DIR ${CMAKE_INSTALL_INCLUDEDIR}/hfremesh)

# What our headers need from whoever compiles them, users included. Bit-identical results need every rounding
# to be the one written: no contraction into fused multiply-add.
set(HFR_PUBLIC_OPTIONS -ffp-contract=off)

# Flags that every target of the project is compiled with; never exported.
add_library(hfr_flags INTERFACE)
target_compile_features(hfr_flags INTERFACE cxx_std_20)
# g++ 12 sees an overlap in "text" + std::to_string(n) that is not there (its bug 105651).
target_compile_options(hfr_flags INTERFACE ${HFR_PUBLIC_OPTIONS} -Wall -Wextra -Wpedantic -Wshadow
  -Wnon-virtual-dtor $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> $<$<BOOL:${HFR_WERROR}>:-Werror>)
if(HFR_PARANOID)
  target_compile_definitions(hfr_flags INTERFACE HFR_PARANOID)
endif()
set(HFR_INSTRUMENT_FLAGS "")
if(HFR_COVERAGE)
  list(APPEND HFR_INSTRUMENT_FLAGS --coverage)
  target_compile_options(hfr_flags INTERFACE -fprofile-update=atomic)
endif()
if(HFR_SANITIZE)
  list(APPEND HFR_INSTRUMENT_FLAGS -fsanitize=${HFR_SANITIZE})
  target_compile_options(hfr_flags INTERFACE -fno-omit-frame-pointer -fno-sanitize-recover=all)
endif()
if(HFR_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang" OR HFR_SANITIZE OR NOT HFR_TESTS)
    message(FATAL_ERROR "HFR_FUZZERS needs clang and HFR_TESTS, and brings its own sanitizers: leave HFR_SANITIZE empty")
  endif()
  list(APPEND HFR_INSTRUMENT_FLAGS -fsanitize=fuzzer-no-link,address,undefined)
  target_compile_options(hfr_flags INTERFACE -fno-omit-frame-pointer -fno-sanitize-recover=all)
endif()
target_compile_options(hfr_flags INTERFACE ${HFR_INSTRUMENT_FLAGS})
target_link_options(hfr_flags INTERFACE ${HFR_INSTRUMENT_FLAGS})

# g++ 12 knows no system headers in a precompiled one, and warns of copies in std::string that it takes for larger
# than memory or than the text.
set(HFR_PCH_OPTIONS "")
if(HFR_PCH)
  set(HFR_PCH_OPTIONS "$<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow;-Wno-array-bounds>")
endif()

# Most of what the compiler reads of a source of ours is the standard library: parsed once for all layers, and once
# more, with GoogleTest, for all tests (unittests/CMakeLists.txt).
set(HFR_STANDARD_HEADERS <algorithm> <array> <atomic> <bit> <cmath> <cstdint> <cstring> <filesystem> <functional>
  <limits> <map> <memory> <numeric> <optional> <ranges> <set> <span> <string> <string_view> <type_traits>
  <unordered_map> <unordered_set> <utility> <vector>)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cc CONTENT "" @ONLY)
if(HFR_PCH_OF_LIBRARY)
  add_library(hfr_precompiled OBJECT ${PROJECT_BINARY_DIR}/precompiled.cc)
  set_target_properties(hfr_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(hfr_precompiled PRIVATE hfr_flags)
  target_precompile_headers(hfr_precompiled PRIVATE ${HFR_STANDARD_HEADERS})
endif()

# hfr_public_headers(FOLDER NAME [COMPONENT ...] FILES ...): headers of FOLDER that users include as <hfremesh/NAME/FILE>. Installed
# below include/hfremesh/NAME; in the build tree a header of one line stands there for each, so that whoever has
# the project as a subfolder finds what an installed copy has, and nothing else.
function(hfr_public_headers FOLDER NAME)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "COMPONENT" "FILES")
  if(NOT ARG_COMPONENT)
    set(ARG_COMPONENT ${CMAKE_INSTALL_DEFAULT_COMPONENT_NAME})
  endif()
  set(forwards ${PROJECT_BINARY_DIR}/include/hfremesh/${NAME})
  foreach(file IN LISTS ARG_FILES)
    file(CONFIGURE OUTPUT ${forwards}/${file} CONTENT "#include \"${FOLDER}/${file}\"\n" @ONLY)
    set_property(GLOBAL APPEND PROPERTY HFR_PUBLIC_HEADERS ${forwards}/${file})
    if(HFR_INSTALL)
      install(FILES ${FOLDER}/${file} DESTINATION ${HFR_INCLUDE_DIR}/${NAME} COMPONENT ${ARG_COMPONENT})
    endif()
  endforeach()
endfunction()

# hfr_layer(NAME [SOURCES ...] [HEADERS ...] [PRIVATE_HEADERS ...] [PRIVATE_LIBRARIES ...])
# HEADERS are public: see hfr_public_headers(). They include each other by the names that users have for them, and
# nothing else of the project. PRIVATE_HEADERS stay here. All are verified to compile alone: by the source of their
# name that includes them first, or, where there is none, by themselves (src/CMakeLists.txt).
# PRIVATE_LIBRARIES appear in no public header; cmake/HfrInstall.cmake knows how users of a static library
# find them.
function(hfr_layer NAME)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;HEADERS;PRIVATE_HEADERS;PRIVATE_LIBRARIES")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "hfr_layer(${NAME}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  set(target hfr_${NAME})
  set(below "")
  foreach(layer IN LISTS HFR_LAYERS)
    if(layer STREQUAL NAME)
      break()
    endif()
    list(APPEND below hfr_${layer}_headers)
  endforeach()
  add_library(${target}_headers INTERFACE)
  target_include_directories(${target}_headers INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_BINARY_DIR}/include)
  target_link_libraries(${target}_headers INTERFACE hfr_kernels ${below})
  hfr_public_headers(${CMAKE_CURRENT_SOURCE_DIR} ${NAME} FILES ${ARG_HEADERS})
  foreach(source IN LISTS ARG_SOURCES)
    if(NOT EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source})
      continue()  # made by the build
    endif()
    string(REGEX REPLACE "\\.cc$" ".hh" header ${source})
    file(STRINGS ${CMAKE_CURRENT_SOURCE_DIR}/${source} first REGEX "^#include" LIMIT_COUNT 1)
    if(first MATCHES "/${header}\"$" AND NOT HFR_PCH_OF_LIBRARY AND NOT CMAKE_UNITY_BUILD)
      set_property(GLOBAL APPEND PROPERTY HFR_VERIFIED_HEADERS ${CMAKE_CURRENT_SOURCE_DIR}/${header}
        ${PROJECT_BINARY_DIR}/include/hfremesh/${NAME}/${header})
    endif()
  endforeach()
  list(TRANSFORM ARG_PRIVATE_HEADERS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set_property(GLOBAL APPEND PROPERTY HFR_PRIVATE_HEADERS ${ARG_PRIVATE_HEADERS})
  if(ARG_SOURCES)
    add_library(${target} OBJECT ${ARG_SOURCES})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(${target} PRIVATE hfr_flags ${ARG_PRIVATE_LIBRARIES} PUBLIC ${target}_headers)
    if(HFR_PCH_OF_LIBRARY AND NOT NAME STREQUAL "Parallel")  # which alone is compiled with flags of its own
      target_precompile_headers(${target} REUSE_FROM hfr_precompiled)
    endif()
    set_property(GLOBAL APPEND PROPERTY HFR_OBJECT_LAYERS ${target})
    set_property(GLOBAL APPEND PROPERTY HFR_PRIVATE_LIBRARIES ${ARG_PRIVATE_LIBRARIES})
  endif()
endfunction()

# How sources of tests are compiled: GoogleTest's macros are many lines for each that is written, and nobody waits
# for them to run. What the library decides is compiled as ever.
set(HFR_TEST_OPTIONS $<$<CONFIG:Release,RelWithDebInfo>:-O1> ${HFR_PCH_OPTIONS})

# hfr_test_flags(TARGET): such a target, which links the private libraries of the layers, too.
function(hfr_test_flags TARGET)
  target_compile_options(${TARGET} PRIVATE ${HFR_TEST_OPTIONS})
  if(HFR_PCH)
    target_precompile_headers(${TARGET} REUSE_FROM hfr_precompiled_tests)
  endif()
endfunction()

# How tests with threads run: several at once, so that threads with nothing to do sleep, and leave the cores to others.
set(HFR_TEST_ENVIRONMENT ENVIRONMENT OMP_WAIT_POLICY=passive)

# hfr_test(FOLDER SOURCES ... [LIBRARIES ...]): one executable test_FOLDER of unittests/FOLDER, linked with the
# layers up to and including FOLDER.
function(hfr_test FOLDER)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LIBRARIES")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "hfr_test(${FOLDER}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  add_executable(test_${FOLDER} ${ARG_SOURCES})
  target_link_libraries(test_${FOLDER} PRIVATE hfr_flags hfr_${FOLDER}_headers GTest::gmock GTest::gtest_main
    ${ARG_LIBRARIES})
  get_property(private_libraries GLOBAL PROPERTY HFR_PRIVATE_LIBRARIES)
  foreach(layer IN LISTS HFR_LAYERS)
    if(TARGET hfr_${layer})
      target_link_libraries(test_${FOLDER} PRIVATE hfr_${layer})
    endif()
    if(layer STREQUAL FOLDER)
      break()
    endif()
  endforeach()
  target_link_libraries(test_${FOLDER} PRIVATE ${private_libraries})
  target_include_directories(test_${FOLDER} PRIVATE ${PROJECT_SOURCE_DIR}/unittests)
  hfr_test_flags(test_${FOLDER})
  target_compile_definitions(test_${FOLDER} PRIVATE HFR_TEST_MESHES="${HFR_TEST_MESHES}")
  gtest_discover_tests(test_${FOLDER} TEST_PREFIX ${FOLDER}. DISCOVERY_TIMEOUT 60
    PROPERTIES ${HFR_TEST_ENVIRONMENT})
endfunction()

# Files of the calling folder whose loops should become vector instructions. Nobody reads errno or the
# floating-point flags, which would keep the compiler from them. The values stay what they are.
function(hfr_vector_sources)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "-fno-math-errno;-fno-trapping-math"
    SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# Files of the calling folder that CMAKE_UNITY_BUILD does not compile together with others: they have names of their own,
# in an unnamed namespace, that other files there have, too, or their objects are asked for by name.
function(hfr_sources_apart)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

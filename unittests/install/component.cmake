# SPDX-License-Identifier: BSD-3-Clause
# Configures a project that asks the installed PREFIX for COMPONENT, with the packages WITHOUT hidden: the one line
# that says what lacks has to be LINE.
file(REMOVE_RECURSE ${WORK})
file(WRITE ${WORK}/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(asks LANGUAGES CXX)\n"
  "find_package(hfremesh REQUIRED COMPONENTS ${COMPONENT})\n")
set(hidden "")
foreach(package IN LISTS WITHOUT)
  list(APPEND hidden -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_MAKE_PROGRAM=${MAKE_PROGRAM}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF ${hidden}
  RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE said)
string(REGEX REPLACE "[ \n]+" " " said "${said}")
string(FIND "${said}" "${LINE}" at)
if(code EQUAL 0 OR at LESS 0)
  message(FATAL_ERROR "find_package() ended with ${code} and did not say \"${LINE}\" but: ${said}")
endif()

# SPDX-License-Identifier: BSD-3-Clause
# Configures, builds and runs the project in SOURCE against the installed PREFIX, with RUN before the program's name.
file(REMOVE_RECURSE ${BUILD})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G ${GENERATOR}
    -DCMAKE_MAKE_PROGRAM=${MAKE_PROGRAM} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF ${MORE}
  COMMAND_ERROR_IS_FATAL ANY)
# Another hfremesh on the system must not be what passes this test.
file(STRINGS ${BUILD}/CMakeCache.txt found REGEX "^hfremesh_DIR:")
string(FIND "${found}" "${PREFIX}/" at)
if(at LESS 0)
  message(FATAL_ERROR "find_package() took another copy: ${found}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --config Release COMMAND_ERROR_IS_FATAL ANY)
find_program(CONSUMER consumer PATHS ${BUILD} ${BUILD}/Release NO_DEFAULT_PATH REQUIRED)
execute_process(COMMAND ${RUN} ${CONSUMER} COMMAND_ERROR_IS_FATAL ANY)

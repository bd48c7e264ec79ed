# SPDX-License-Identifier: BSD-3-Clause
# Configures the project in SOURCE with HFREMESH as a part of it, and compiles the object of it that includes our
# headers: none of the library is built for that.
file(REMOVE_RECURSE ${BUILD})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G ${GENERATOR}
    -DCMAKE_MAKE_PROGRAM=${MAKE_PROGRAM} -DCMAKE_CXX_COMPILER=${COMPILER} -DHFREMESH=${HFREMESH}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --target subproject COMMAND_ERROR_IS_FATAL ANY)

# SPDX-License-Identifier: BSD-3-Clause
# Compiles, links and runs SOURCE with one command line, as a Makefile would.
string(APPEND WORK /program)
include(${CMAKE_CURRENT_LIST_DIR}/pkg_config_flags.cmake)
hfr_pkg_config(flags --cflags --libs)
execute_process(COMMAND ${COMPILER} -std=c++20 ${FLAGS} ${SOURCE} -o ${WORK}/consumer ${flags}
  COMMAND_ERROR_IS_FATAL ANY)
set(ENV{LD_LIBRARY_PATH} ${PREFIX}/${LIBDIR}:$ENV{LD_LIBRARY_PATH})
execute_process(COMMAND ${WORK}/consumer COMMAND_ERROR_IS_FATAL ANY)

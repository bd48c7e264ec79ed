# SPDX-License-Identifier: BSD-3-Clause
# The lines of `PROGRAM THREADS` must be those of one thread with baseline instructions.
execute_process(COMMAND ${CMAKE_COMMAND} -E env HFR_VECTORS=baseline ${PROGRAM} 1
  OUTPUT_VARIABLE expected COMMAND_ERROR_IS_FATAL ANY)
set(widths avx512)
if(THREADS EQUAL 1)
  list(APPEND widths avx2)
endif()
foreach(vectors IN LISTS widths)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env HFR_VECTORS=${vectors} ${PROGRAM} ${THREADS}
    OUTPUT_VARIABLE found COMMAND_ERROR_IS_FATAL ANY)
  if(NOT found STREQUAL expected)
    message(FATAL_ERROR "${THREADS} threads, ${vectors}:\n${found}one thread, baseline:\n${expected}")
  endif()
endforeach()

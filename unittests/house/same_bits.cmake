# SPDX-License-Identifier: BSD-3-Clause
# The lines of PROGRAM are those of one thread with baseline instructions, for any number of threads and with any.
function(run vectors threads)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env HFR_VECTORS=${vectors} ${PROGRAM} ${threads}
    OUTPUT_VARIABLE found COMMAND_ERROR_IS_FATAL ANY)
  if(NOT DEFINED expected)
    set(expected "${found}" PARENT_SCOPE)
  elseif(NOT found STREQUAL expected)
    message(FATAL_ERROR "${threads} threads, ${vectors}:\n${found}one thread, baseline:\n${expected}")
  endif()
endfunction()

run(baseline 1)
run(avx2 1)
foreach(threads IN ITEMS 1 2 3 7 16)
  run(avx512 ${threads})
endforeach()

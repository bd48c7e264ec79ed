# SPDX-License-Identifier: BSD-3-Clause
# cmake -D TOOL=hfremesh -D WITHOUT=hfremesh_without_surface -D FOLDER=out -P without_surface.cmake
# What the tool does without OpenMesh: with a frozen surface the bytes of the whole tool; a line and exit code 1
# for all that needs more.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
set(in ${FOLDER}/in.mesh)
execute_process(COMMAND ${TOOL} generate cavity --n 8 8 8 -q -o ${in} COMMAND_ERROR_IS_FATAL ANY)

foreach(options "" "--min-dihedral;25")
  foreach(program IN ITEMS TOOL WITHOUT)
    execute_process(COMMAND ${${program}} improve ${in} -q -o ${FOLDER}/${program}.mesh ${options}
      RESULT_VARIABLE code_${program} ERROR_VARIABLE errors)
    if(NOT code_${program} MATCHES "^[03]$")
      message(FATAL_ERROR "${${program}} ${options} ends with ${code_${program}}: ${errors}")
    endif()
    file(SHA256 ${FOLDER}/${program}.mesh hash_${program})
  endforeach()
  file(SHA256 ${in} hash_in)
  if(NOT code_TOOL EQUAL code_WITHOUT OR NOT hash_TOOL STREQUAL hash_WITHOUT)
    message(FATAL_ERROR "improve ${options}: another mesh without OpenMesh")
  endif()
  if(hash_TOOL STREQUAL hash_in)
    message(FATAL_ERROR "improve ${options} changes nothing: this shows nothing")
  endif()
endforeach()

foreach(options "--surface;flat" "--surface;free" "--label-features")
  execute_process(COMMAND ${WITHOUT} improve ${in} -q -o ${FOLDER}/refused.mesh ${options}
    RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT code EQUAL 1 OR NOT errors MATCHES "^hfremesh: [^\n]*built without OpenMesh[^\n]*\n$")
    message(FATAL_ERROR "improve ${options} ends with ${code} and says: ${errors}")
  endif()
  if(EXISTS ${FOLDER}/refused.mesh OR NOT output STREQUAL "")
    message(FATAL_ERROR "improve ${options} is refused and writes something: ${output}")
  endif()
endforeach()

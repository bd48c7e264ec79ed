# SPDX-License-Identifier: BSD-3-Clause
# hfr_pkg_config(VARIABLE OPTION ...): what pkg-config says of the copy installed below PREFIX, as a list.
function(hfr_pkg_config VARIABLE)
  set(ENV{PKG_CONFIG_PATH} ${PREFIX}/${LIBDIR}/pkgconfig)
  execute_process(COMMAND ${PKG_CONFIG} ${STATIC} ${ARGN} hfremesh OUTPUT_VARIABLE flags
    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  set(${VARIABLE} ${flags} PARENT_SCOPE)
endfunction()

separate_arguments(FLAGS UNIX_COMMAND "${FLAGS}")
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})

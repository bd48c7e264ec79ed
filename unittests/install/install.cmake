# SPDX-License-Identifier: BSD-3-Clause
# Installs BUILD below another folder and renames that to PREFIX: what was installed must not know where it lay.
file(REMOVE_RECURSE ${PREFIX} ${PREFIX}.before)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX}.before
  COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${PREFIX}.before ${PREFIX})

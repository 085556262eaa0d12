# SPDX-License-Identifier: BSD-3-Clause
# Script of the test install_stratimikos: the same problem by Belos alone, with MueLu, and by Haptos, as files of parameters tell.
include(${CMAKE_CURRENT_LIST_DIR}/install_copy.cmake)
step("build" ${CMAKE_COMMAND} --build ${work}/build)
set(files ${work}/source/muelu.xml ${work}/source/belos.xml ${work}/source/haptos.xml)
run_alike("[0-9]+ unknowns" "1;2;3" ${work}/build/solvers ${files})   # two of three ranks solve
file(REMOVE_RECURSE ${work})

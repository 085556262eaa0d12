# SPDX-License-Identifier: BSD-3-Clause
# Script of the test install_stranger.
include(${CMAKE_CURRENT_LIST_DIR}/install_copy.cmake)
step("build" ${CMAKE_COMMAND} --build ${work}/build)
step("run" ${MPIRUN} -n 2 ${work}/build/stranger)
message(STATUS "${output}")

# Its own elements in contact, ten steps by half of the ranks; its own nonlinear material; its own dual operators through Belos, by
# half of the ranks: the same answer whoever has them.
run_alike("tip [^;]*;" "1;2;4" ${work}/build/layers)
run_alike("tip [^;]*;" "1;2" ${work}/build/quasistatic)
run_alike("length [^;]*;" "1;2;4" ${work}/build/contact)

# A place without Exodus, METIS, muParser and JSON is enough for qp; who wants more is told what is missing.
set(nothing -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON)
foreach(library exoIIv2c metis muparser)
  list(APPEND nothing -DHAPTOS_${library}_LIBRARY= -DHAPTOS_${library}_INCLUDE_DIR=)
endforeach()
step("configure with qp alone" ${configure} ${nothing} -B ${work}/qp -DCOMPONENT=qp)
step("build with qp alone" ${CMAKE_COMMAND} --build ${work}/qp)
step("run with qp alone" ${MPIRUN} -n 2 ${work}/qp/stranger)

function(refused component)   # ... what the message must say
  execute_process(COMMAND ${configure} ${nothing} -B ${work}/refused_${component} -DCOMPONENT=${component}
                  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  foreach(part IN LISTS ARGN)
    string(FIND "${output}" "${part}" at)
    if(status EQUAL 0 OR at EQUAL -1)
      fail("asking for component '${component}' does not say '${part}' (${status}):\n${output}")
    endif()
  endforeach()
endfunction()
refused(mesh "component 'mesh' needs Exodus II (libexodusii-dev), which is not found here")
refused(decomposition "needs Exodus II" "needs METIS (libmetis-dev)")
refused("" "component 'results' needs nlohmann's JSON 3 (nlohmann-json3-dev)" "component 'input' needs muParser")
refused(mech "there is no component 'mech', there are")

# It was the installed copy that was used, and our warnings are not forced on others.
file(READ ${work}/build/compile_commands.json commands)
if(NOT commands MATCHES "installed copy/include/haptos")
  fail("the stranger did not use the installed headers:\n${commands}")
endif()
if(commands MATCHES "-Wextra")
  fail("Haptos forces its warnings on the stranger:\n${commands}")
endif()

# The copy can be moved away from the build.
file(GLOB exported ${prefix}/lib/cmake/Haptos/*.cmake)
foreach(file IN LISTS exported)
  file(READ ${file} text)
  string(FIND "${text}" "${BUILD_DIR}" leak)
  if(NOT leak EQUAL -1)
    fail("${file} names the build folder ${BUILD_DIR}")
  endif()
endforeach()
file(REMOVE_RECURSE ${work})

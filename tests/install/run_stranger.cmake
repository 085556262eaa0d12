# SPDX-License-Identifier: BSD-3-Clause
# Script of the test install_stranger; its variables come from CMakeLists.txt beside it.
execute_process(COMMAND mktemp -d OUTPUT_VARIABLE work OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(prefix "${work}/installed copy")   # a blank, as in many people's folders
file(COPY ${STRANGER_DIR}/ DESTINATION ${work}/source)

function(fail what)
  file(REMOVE_RECURSE ${work})
  message(NOTICE "${what}")
  message(FATAL_ERROR "install_stranger failed, see above")
endfunction()

function(step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    fail("${what} failed (${status}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

step("install" ${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
set(configure ${CMAKE_COMMAND} -S ${work}/source -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_CXX_COMPILER=${CXX_COMPILER} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
  "-DCMAKE_PREFIX_PATH=${prefix}" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON)
step("configure" ${configure} -B ${work}/build)
step("build" ${CMAKE_COMMAND} --build ${work}/build)
step("run" ${MPIRUN} -n 2 ${work}/build/stranger)
message(STATUS "${output}")

# Its own elements in contact, ten steps by half of the ranks: the same answer whoever has them.
foreach(ranks 1 2 4)
  step("run layers on ${ranks} ranks" ${MPIRUN} -n ${ranks} ${work}/build/layers)
  message(STATUS "${ranks} ranks: ${output}")
  string(REGEX MATCH "tip [^;]*;" tip_${ranks} "${output}")
  if(NOT tip_${ranks} OR NOT tip_${ranks} STREQUAL tip_1)
    fail("the answer of layers depends on the ranks: '${tip_1}' on one, '${tip_${ranks}}' on ${ranks}")
  endif()
endforeach()

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

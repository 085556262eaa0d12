# SPDX-License-Identifier: BSD-3-Clause
# Installs a build into a new folder and configures the project PROJECT_DIR with the copy; `prefix`, `work` and `configure` are what scripts
# that include this go on with.  Their variables come from CMakeLists.txt beside this.
execute_process(COMMAND mktemp -d OUTPUT_VARIABLE work OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(prefix "${work}/installed copy")   # a blank, as in many people's folders
file(COPY ${PROJECT_DIR}/ DESTINATION ${work}/source)

function(fail what)
  file(REMOVE_RECURSE ${work})
  message(NOTICE "${what}")
  message(FATAL_ERROR "${PROJECT_DIR} failed with the installed copy, see above")
endfunction()

function(step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    fail("${what} failed (${status}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# run_alike(<regex> <ranks> <program> [args]): by each of the numbers of ranks; what the regex finds must be the same.
function(run_alike regex ranks)
  set(first "")
  foreach(n IN LISTS ranks)
    step("${ARGN} on ${n} ranks" ${MPIRUN} -n ${n} ${ARGN})
    message(STATUS "${n} ranks:\n${output}")
    string(REGEX MATCHALL "${regex}" found "${output}")
    if(NOT found OR (first AND NOT found STREQUAL first))
      fail("the answer of ${ARGN} depends on the ranks: '${first}', but '${found}' on ${n}")
    endif()
    set(first "${found}")
  endforeach()
endfunction()

step("install" ${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
set(configure ${CMAKE_COMMAND} -S ${work}/source -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_CXX_COMPILER=${CXX_COMPILER} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
  "-DCMAKE_PREFIX_PATH=${prefix}" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON)
step("configure" ${configure} -B ${work}/build)

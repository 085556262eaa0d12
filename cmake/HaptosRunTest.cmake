# SPDX-License-Identifier: BSD-3-Clause
# cmake -DSTATUS=n -DTEXT=regex -P HaptosRunTest.cmake -- command...
# Runs a command; it passes if its exit status is n AND its output has the text: neither alone tells that a program came to
# its end and found all well (it may crash after its last line, or end early with status 0).
set(command "")
set(past_dashes FALSE)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE ${last})
  if(past_dashes)
    list(APPEND command "${CMAKE_ARGV${i}}")
  elseif(CMAKE_ARGV${i} STREQUAL "--")
    set(past_dashes TRUE)
  endif()
endforeach()
execute_process(COMMAND ${command} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output
                ECHO_OUTPUT_VARIABLE ECHO_ERROR_VARIABLE)
if(NOT status STREQUAL STATUS)
  message(FATAL_ERROR "exit status ${status} instead of ${STATUS}")
endif()
if(NOT output MATCHES "${TEXT}")
  message(FATAL_ERROR "the output lacks '${TEXT}'")
endif()

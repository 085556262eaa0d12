# SPDX-License-Identifier: BSD-3-Clause
include_guard(GLOBAL)

# haptos_add_package(<name> HEADERS ... PRIVATE_HEADERS ... SOURCES ... DEPENDS ... [PRIVATE_DEPENDS ...])
# One static library per folder under packages/, target Haptos::<name>.  HEADERS are installed, PRIVATE_HEADERS not:
# tests/style/arrows.py tells which is which, and what a package may include.
function(haptos_add_package name)
  cmake_parse_arguments(arg "" "" "HEADERS;PRIVATE_HEADERS;SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(haptos_${name} ${arg_SOURCES} ${arg_HEADERS} ${arg_PRIVATE_HEADERS})
  add_library(Haptos::${name} ALIAS haptos_${name})
  set_target_properties(haptos_${name} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF)
  target_compile_features(haptos_${name} PUBLIC cxx_std_17)
  target_include_directories(haptos_${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include/haptos>)
  target_link_libraries(haptos_${name} PUBLIC ${arg_DEPENDS} PRIVATE ${arg_PRIVATE_DEPENDS} haptos_warnings)
  install(TARGETS haptos_${name} EXPORT HaptosTargets ARCHIVE DESTINATION lib LIBRARY DESTINATION lib)
  install(FILES ${arg_HEADERS} DESTINATION include/haptos)
  set_property(GLOBAL APPEND PROPERTY HAPTOS_PACKAGES ${name})
endfunction()

# haptos_add_test(<name> SOURCES ... DEPENDS ... RANKS 1 2 LABELS "unit;qp" [TIMEOUT s] [ARGS ...])
# A Teuchos unit test program, run once per number of ranks.
function(haptos_add_test name)
  cmake_parse_arguments(arg "" "TIMEOUT" "SOURCES;DEPENDS;RANKS;LABELS;ARGS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  add_executable(test_${name} ${arg_SOURCES} ${HAPTOS_UNIT_TEST_MAIN})
  set_target_properties(test_${name} PROPERTIES CXX_EXTENSIONS OFF)
  target_link_libraries(test_${name} PRIVATE ${arg_DEPENDS} Haptos::trilinos haptos_warnings)
  foreach(ranks IN LISTS arg_RANKS)
    add_test(NAME ${name}_np${ranks} COMMAND ${HAPTOS_MPIRUN} -n ${ranks} $<TARGET_FILE:test_${name}> ${arg_ARGS})
    set_tests_properties(${name}_np${ranks} PROPERTIES
      LABELS "${arg_LABELS}" PROCESSORS ${ranks} TIMEOUT ${arg_TIMEOUT}
      ENVIRONMENT "OPENBLAS_NUM_THREADS=1;OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_mpi_yield_when_idle=1"
      PASS_REGULAR_EXPRESSION "End Result: TEST PASSED" FAIL_REGULAR_EXPRESSION "End Result: TEST FAILED")
  endforeach()
endfunction()

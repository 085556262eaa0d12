# SPDX-License-Identifier: BSD-3-Clause
include_guard(GLOBAL)

# Half of what a build cost were headers of Trilinos and Eigen, read anew by each unit: they are read once for all packages and once for all tests, whose
# code is not position independent.  No header of ours is among them, and a build without (nightly.sh) tells of includes that are missing.
option(HAPTOS_PRECOMPILE "Precompile headers of Trilinos and Eigen" ON)
function(haptos_precompile target headers independent)
  if(NOT HAPTOS_PRECOMPILE)
    return()
  endif()
  if(NOT TARGET ${headers})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${headers}.cpp CONTENT "")  # untouched when configured again
    add_library(${headers} OBJECT ${PROJECT_BINARY_DIR}/${headers}.cpp)
    set_target_properties(${headers} PROPERTIES POSITION_INDEPENDENT_CODE ${independent} CXX_EXTENSIONS OFF)
    target_link_libraries(${headers} PRIVATE Haptos::trilinos Haptos::eigen haptos_warnings)
    target_precompile_headers(${headers} PRIVATE <Eigen/SparseCore> <Teuchos_CommHelpers.hpp> <Teuchos_ParameterList.hpp> <Teuchos_RCP.hpp>
      <Tpetra_MultiVector.hpp> <algorithm> <cmath> <functional> <map> <optional> <string> <vector>)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()

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
  haptos_precompile(haptos_${name} haptos_headers ON)
  install(TARGETS haptos_${name} EXPORT HaptosTargets ARCHIVE DESTINATION lib LIBRARY DESTINATION lib)
  install(FILES ${arg_HEADERS} DESTINATION include/haptos)
  set_property(GLOBAL APPEND PROPERTY HAPTOS_PACKAGES ${name})
endfunction()

# What every test runs in: one thread a rank, and MPI that lets ranks share cores and does not wait a second before it ends the ranks of a run that
# ends with status 1.
set(HAPTOS_TEST_ENVIRONMENT OPENBLAS_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_odls_base_sigkill_timeout=0 PYTHONDONTWRITEBYTECODE=1
    LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/cmake/leaks_of_others.txt:print_suppressions=0)

# What LeakSanitizer finds in a plugin of MPI can be told from what is ours only as long as the plugin is loaded: tests begin with a
# library whose dlclose does nothing.  It is no sanitised one, so it is made before their flags are added.
function(haptos_keep_libraries_loaded)
  add_library(haptos_keep_libraries MODULE ${PROJECT_SOURCE_DIR}/cmake/KeepLibraries.cpp)
  set_target_properties(haptos_keep_libraries PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  list(APPEND HAPTOS_TEST_ENVIRONMENT LD_PRELOAD=${PROJECT_BINARY_DIR}/lib/libhaptos_keep_libraries.so ASAN_OPTIONS=verify_asan_link_order=0)
  set(HAPTOS_TEST_ENVIRONMENT "${HAPTOS_TEST_ENVIRONMENT}" PARENT_SCOPE)
endfunction()

# Of slow builds (tests/nightly.sh).
set(HAPTOS_TIMEOUT_SCALE 1 CACHE STRING "Time limits of tests are this many times the usual ones")

# haptos_add_run(<test> COMMAND ... [STATUS n] TEXT regex [RANKS n] LABELS ... [TIMEOUT s])
# A program that must end with the status (0) and say the text.
function(haptos_add_run name)
  cmake_parse_arguments(arg "" "STATUS;TEXT;RANKS;TIMEOUT" "COMMAND;LABELS" ${ARGN})
  foreach(default STATUS=0 RANKS=1 TIMEOUT=300)
    string(REGEX MATCH "(.*)=(.*)" unused ${default})
    if(NOT DEFINED arg_${CMAKE_MATCH_1})
      set(arg_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
    endif()
  endforeach()
  math(EXPR limit "${arg_TIMEOUT} * ${HAPTOS_TIMEOUT_SCALE}")
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -DSTATUS=${arg_STATUS} -DTEXT=${arg_TEXT}
           -P ${PROJECT_SOURCE_DIR}/cmake/HaptosRunTest.cmake -- ${arg_COMMAND})
  set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}" PROCESSORS ${arg_RANKS} TIMEOUT ${limit}
    ENVIRONMENT "${HAPTOS_TEST_ENVIRONMENT}")
endfunction()

# haptos_add_test(<name> SOURCES ... DEPENDS ... RANKS 1 2 LABELS "unit;qp" [TIMEOUT s] [ARGS ...])
# A Teuchos unit test program, run once per number of ranks.
function(haptos_add_test name)
  cmake_parse_arguments(arg "" "TIMEOUT" "SOURCES;DEPENDS;RANKS;LABELS;ARGS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  if(NOT TARGET haptos_unit_test_main)  # compiled once, for all of them
    add_library(haptos_unit_test_main OBJECT ${PROJECT_SOURCE_DIR}/cmake/UnitTestMain.cpp)
    set_target_properties(haptos_unit_test_main PROPERTIES CXX_EXTENSIONS OFF)
    target_link_libraries(haptos_unit_test_main PRIVATE Haptos::trilinos haptos_warnings)
  endif()
  add_executable(test_${name} ${arg_SOURCES} $<TARGET_OBJECTS:haptos_unit_test_main>)
  set_target_properties(test_${name} PROPERTIES CXX_EXTENSIONS OFF)
  target_link_libraries(test_${name} PRIVATE ${arg_DEPENDS} haptos_test_dense Haptos::trilinos haptos_warnings)
  haptos_precompile(test_${name} haptos_test_headers OFF)
  foreach(ranks IN LISTS arg_RANKS)
    haptos_add_run(${name}_np${ranks} COMMAND ${HAPTOS_MPIRUN} -n ${ranks} $<TARGET_FILE:test_${name}> ${arg_ARGS}
                   TEXT "End Result: TEST PASSED" RANKS ${ranks} LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT})
  endforeach()
endfunction()

# haptos_add_python_test(<name> SCRIPT ... LABELS ... [RANKS n] [TIMEOUT s]): a script and its arguments, by the python3 that
# is first on PATH when it runs (`bootstrap.sh test` puts build/venv there).  Without Python it fails; where a package is
# missing it ends with status 77 and counts as skipped.
set(HAPTOS_PYTHON "" CACHE FILEPATH "Python for the tests; empty: the first python3 on PATH when they run")
function(haptos_add_python_test name)
  cmake_parse_arguments(arg "" "RANKS;TIMEOUT" "SCRIPT;LABELS" ${ARGN})
  if(HAPTOS_PYTHON)
    set(python ${HAPTOS_PYTHON})
  else()
    set(python /usr/bin/env python3)
  endif()
  if(NOT arg_RANKS)
    set(arg_RANKS 1)
  endif()
  math(EXPR limit "${arg_TIMEOUT} * ${HAPTOS_TIMEOUT_SCALE}")
  add_test(NAME ${name} COMMAND ${python} ${arg_SCRIPT})
  set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}" PROCESSORS ${arg_RANKS} TIMEOUT ${limit}
    SKIP_RETURN_CODE 77 ENVIRONMENT "${HAPTOS_TEST_ENVIRONMENT}")
endfunction()

# SPDX-License-Identifier: BSD-3-Clause
# Debian's Trilinos 13.2 exports un-namespaced targets without usage requirements;
# this file turns them, and the other libraries we need, into modern targets.
# The installed HaptosConfig.cmake includes this same file.
include_guard(GLOBAL)
include(CMakeFindDependencyMacro)

find_package(MPI REQUIRED COMPONENTS CXX)
find_package(Trilinos 13.2 REQUIRED COMPONENTS Tpetra Amesos2 Belos Intrepid2 Shards Teuchos)

# IMPORTED, so that it needs no export.
add_library(Haptos::trilinos INTERFACE IMPORTED GLOBAL)
set(_haptos_tpl_dirs ${Trilinos_TPL_INCLUDE_DIRS})
list(REMOVE_ITEM _haptos_tpl_dirs /usr/include)      # -isystem /usr/include breaks <cstdlib>
target_include_directories(Haptos::trilinos SYSTEM INTERFACE ${Trilinos_INCLUDE_DIRS} ${_haptos_tpl_dirs})
target_link_libraries(Haptos::trilinos INTERFACE ${Trilinos_LIBRARIES} MPI::MPI_CXX)
target_compile_features(Haptos::trilinos INTERFACE cxx_std_17)
target_compile_definitions(Haptos::trilinos INTERFACE OMPI_SKIP_MPICXX)

find_package(Eigen3 3.3 REQUIRED NO_MODULE)
add_library(Haptos::eigen INTERFACE IMPORTED GLOBAL)
target_link_libraries(Haptos::eigen INTERFACE Eigen3::Eigen)

function(haptos_find_library target header library)
  string(MAKE_C_IDENTIFIER "HAPTOS_${library}" id)
  find_path(${id}_INCLUDE_DIR NAMES ${header} PATH_SUFFIXES suitesparse)
  find_library(${id}_LIBRARY NAMES ${library})
  if(${id}_INCLUDE_DIR AND ${id}_LIBRARY)
    add_library(${target} INTERFACE IMPORTED GLOBAL)
    if(NOT ${id}_INCLUDE_DIR STREQUAL /usr/include)
      target_include_directories(${target} SYSTEM INTERFACE ${${id}_INCLUDE_DIR})
    endif()
    target_link_libraries(${target} INTERFACE ${${id}_LIBRARY})
  endif()
endfunction()

haptos_find_library(Haptos::metis metis.h metis)
haptos_find_library(Haptos::muparser muParser.h muparser)
haptos_find_library(Haptos::exodus exodusII.h exoIIv2c)
haptos_find_library(Haptos::cholmod cholmod.h cholmod)   # optional: its supernodal module is GPL
haptos_find_library(Haptos::nanoflann nanoflann.hpp m)
find_package(nlohmann_json 3 REQUIRED)
add_library(Haptos::json INTERFACE IMPORTED GLOBAL)
target_link_libraries(Haptos::json INTERFACE nlohmann_json::nlohmann_json)

foreach(_haptos_needed metis muparser exodus)
  if(NOT TARGET Haptos::${_haptos_needed})
    message(FATAL_ERROR "Haptos needs ${_haptos_needed}; ./bootstrap.sh installs it on Debian.")
  endif()
endforeach()
if(NOT TARGET Haptos::cholmod)
  message(STATUS "CHOLMOD not found: local factorisations fall back to KLU2 (slower)")
endif()

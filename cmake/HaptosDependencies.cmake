# SPDX-License-Identifier: BSD-3-Clause
# haptos_find(<name>): one of the libraries that Haptos needs, as a target Haptos::<name>; no such target where it is not
# found.  The installed HaptosConfig.cmake includes this same file and looks only for what the wanted components need.

# haptos_link_trilinos(<target> <package> <all>): a package of Trilinos, or Trilinos itself, as it was found.  From 14 on there are
# targets with usage requirements; Debian's 13.2 exports libraries without any.
function(haptos_link_trilinos target package all)
  if(TARGET ${all})
    target_link_libraries(${target} INTERFACE ${all})
    return()
  endif()
  set(tpl_dirs ${${package}_TPL_INCLUDE_DIRS})
  list(REMOVE_ITEM tpl_dirs /usr/include)      # -isystem /usr/include breaks <cstdlib>
  target_include_directories(${target} SYSTEM INTERFACE ${${package}_INCLUDE_DIRS} ${tpl_dirs})
  target_link_libraries(${target} INTERFACE ${${package}_LIBRARIES})
endfunction()

# Its version file knows no newer major version as compatible: the version is compared here.  17 wants C++20.
function(haptos_find_trilinos)
  find_package(MPI QUIET COMPONENTS CXX)
  find_package(Trilinos QUIET COMPONENTS Tpetra Amesos2 Belos Intrepid2 Shards Teuchos)
  if(NOT MPI_CXX_FOUND OR NOT Trilinos_FOUND OR Trilinos_VERSION VERSION_LESS 13.2)
    return()
  endif()
  add_library(Haptos::trilinos INTERFACE IMPORTED)
  haptos_link_trilinos(Haptos::trilinos Trilinos Trilinos::all_selected_libs)
  target_link_libraries(Haptos::trilinos INTERFACE MPI::MPI_CXX)
  if(Trilinos_VERSION VERSION_LESS 17)
    target_compile_features(Haptos::trilinos INTERFACE cxx_std_17)
  else()
    target_compile_features(Haptos::trilinos INTERFACE cxx_std_20)
  endif()
  target_compile_definitions(Haptos::trilinos INTERFACE OMPI_SKIP_MPICXX)
endfunction()

# Stratimikos, for linear problems of those who choose their solvers by it.
function(haptos_find_thyra)
  find_package(Stratimikos QUIET)
  find_package(ThyraTpetraAdapters QUIET)
  if(Stratimikos_FOUND AND ThyraTpetraAdapters_FOUND)
    add_library(Haptos::thyra INTERFACE IMPORTED)
    haptos_link_trilinos(Haptos::thyra Stratimikos Stratimikos::all_libs)
    haptos_link_trilinos(Haptos::thyra ThyraTpetraAdapters ThyraTpetraAdapters::all_libs)
  endif()
endfunction()

# For those who link the C interface, whose project may have no C++.
function(haptos_find_mpi_c)
  find_package(MPI QUIET COMPONENTS C)
  if(MPI_C_FOUND)
    add_library(Haptos::mpi_c INTERFACE IMPORTED)
    target_link_libraries(Haptos::mpi_c INTERFACE MPI::MPI_C)
  endif()
endfunction()

# A package with CMake files of its own.
function(haptos_find_package name package version target)
  find_package(${package} ${version} QUIET)
  if(TARGET ${target})
    add_library(Haptos::${name} INTERFACE IMPORTED)
    target_link_libraries(Haptos::${name} INTERFACE ${target})
  endif()
endfunction()

function(haptos_find_library name header library)
  string(MAKE_C_IDENTIFIER "HAPTOS_${library}" id)
  find_path(${id}_INCLUDE_DIR NAMES ${header} PATH_SUFFIXES suitesparse)
  find_library(${id}_LIBRARY NAMES ${library})
  if(${id}_INCLUDE_DIR AND ${id}_LIBRARY)
    add_library(Haptos::${name} INTERFACE IMPORTED)
    if(NOT ${id}_INCLUDE_DIR STREQUAL /usr/include)
      target_include_directories(Haptos::${name} SYSTEM INTERFACE ${${id}_INCLUDE_DIR})
    endif()
    target_link_libraries(Haptos::${name} INTERFACE ${${id}_LIBRARY})
  endif()
endfunction()

# Products and triangular solves of large matrices go to the BLAS, whose kernels know the processor: Eigen's are compiled for any, with SSE2
# on x86-64.  Products with vectors stay Eigen's (the macros are the guards of its files for them): they are as fast, and a BLAS complains about empty
# matrices.  One setting for all units, as of templates that differ in it the linker would take any.
function(haptos_find_eigen)
  haptos_find_package(eigen Eigen3 3.3 Eigen3::Eigen)
  if(TARGET Haptos::eigen)
    target_compile_definitions(Haptos::eigen INTERFACE EIGEN_USE_BLAS EIGEN_GENERAL_MATRIX_VECTOR_BLAS_H
      EIGEN_SELFADJOINT_MATRIX_VECTOR_BLAS_H EIGEN_TRIANGULAR_MATRIX_VECTOR_BLAS_H)
  endif()
endfunction()

# name; what a person would look for, on Debian
set(HAPTOS_trilinos_IS "MPI and Trilinos, 13.2 or newer (trilinos-all-dev, libptscotch-dev, libopenmpi-dev)")
set(HAPTOS_thyra_IS "Trilinos' Stratimikos and ThyraTpetraAdapters (trilinos-all-dev)")
set(HAPTOS_mpi_c_IS "MPI for C (libopenmpi-dev) in a project with the language C")
set(HAPTOS_eigen_IS "Eigen 3.3 (libeigen3-dev)")
set(HAPTOS_json_IS "nlohmann's JSON 3 (nlohmann-json3-dev)")
set(HAPTOS_metis_IS "METIS (libmetis-dev)")
set(HAPTOS_muparser_IS "muParser (libmuparser-dev)")
set(HAPTOS_exodus_IS "Exodus II (libexodusii-dev)")
set(HAPTOS_cholmod_IS "CHOLMOD (libsuitesparse-dev)")

macro(haptos_find name)
  if(TARGET Haptos::${name})
  elseif("${name}" STREQUAL "trilinos")
    haptos_find_trilinos()
  elseif("${name}" STREQUAL "thyra")
    haptos_find_thyra()
  elseif("${name}" STREQUAL "mpi_c")
    haptos_find_mpi_c()
  elseif("${name}" STREQUAL "eigen")
    haptos_find_eigen()
  elseif("${name}" STREQUAL "json")
    haptos_find_package(json nlohmann_json 3 nlohmann_json::nlohmann_json)
  elseif("${name}" STREQUAL "metis")
    haptos_find_library(metis metis.h metis)
  elseif("${name}" STREQUAL "muparser")
    haptos_find_library(muparser muParser.h muparser)
  elseif("${name}" STREQUAL "exodus")
    haptos_find_library(exodus exodusII.h exoIIv2c)
  elseif("${name}" STREQUAL "cholmod")
    haptos_find_library(cholmod cholmod.h cholmod)
  endif()
endmacro()

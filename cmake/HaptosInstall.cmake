# SPDX-License-Identifier: BSD-3-Clause
# Installs what find_package(Haptos) needs.  The packages install their own libraries and headers
# (haptos_add_package), drivers/ its programs.
include_guard(GLOBAL)
include(CMakePackageConfigHelpers)

# All packages as one target, for those who do not want to choose; without what other languages and packages want.
get_property(_haptos_packages GLOBAL PROPERTY HAPTOS_PACKAGES)
add_library(haptos_all INTERFACE)
add_library(Haptos::haptos ALIAS haptos_all)
set_target_properties(haptos_all PROPERTIES EXPORT_NAME haptos)
get_property(HAPTOS_EXTRA_COMPONENTS GLOBAL PROPERTY HAPTOS_EXTRA_PACKAGES)
foreach(_haptos_package IN LISTS _haptos_packages)
  if(NOT _haptos_package IN_LIST HAPTOS_EXTRA_COMPONENTS)
    target_link_libraries(haptos_all INTERFACE haptos_${_haptos_package})
  endif()
endforeach()
install(TARGETS haptos_all EXPORT HaptosTargets)

# Libraries that who links a package links too; packages come after what they need.
set(HAPTOS_COMPONENTS ${_haptos_packages})
set(HAPTOS_NEEDS "")
foreach(_haptos_package IN LISTS _haptos_packages)
  set(_haptos_needs_${_haptos_package} "")
  get_target_property(_haptos_links haptos_${_haptos_package} INTERFACE_LINK_LIBRARIES)
  foreach(_haptos_link IN LISTS _haptos_links)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" _haptos_link "${_haptos_link}")
    string(REPLACE "Haptos::" "" _haptos_name "${_haptos_link}")
    if(_haptos_name IN_LIST _haptos_packages)
      list(APPEND _haptos_needs_${_haptos_package} ${_haptos_needs_${_haptos_name}})
    elseif(_haptos_link MATCHES "^Haptos::")
      list(APPEND _haptos_needs_${_haptos_package} ${_haptos_name})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES _haptos_needs_${_haptos_package})
  string(APPEND HAPTOS_NEEDS "set(_haptos_needs_${_haptos_package} ${_haptos_needs_${_haptos_package}})\n")
endforeach()

set(_haptos_config_dir lib/cmake/Haptos)
install(EXPORT HaptosTargets NAMESPACE Haptos:: DESTINATION ${_haptos_config_dir})
configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/HaptosConfig.cmake.in ${PROJECT_BINARY_DIR}/HaptosConfig.cmake
  INSTALL_DESTINATION ${_haptos_config_dir} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break users.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/HaptosConfigVersion.cmake
  VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/HaptosConfig.cmake
  ${PROJECT_BINARY_DIR}/HaptosConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/HaptosDependencies.cmake
  DESTINATION ${_haptos_config_dir})

# SPDX-License-Identifier: MIT
# Dependencies of the library and the installed package.

# Before 1.0 a minor version may change the interface, and with it what a program that is linked already would call.
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(FLOTILLA_COMPATIBILITY SameMinorVersion)
  set(FLOTILLA_SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
else()
  set(FLOTILLA_COMPATIBILITY SameMajorVersion)
  set(FLOTILLA_SOVERSION ${PROJECT_VERSION_MAJOR})
endif()

# flotilla_link_package(Package [VERSION v] [COMPONENTS c...] TARGETS t...)
# Finds a package that the library needs at link time and links it privately. A program that links the installed static
# library needs it too, so the package configuration will look for it; headers never do. (A header-only dependency is
# linked with $<BUILD_INTERFACE:...> instead and leaves no trace in the package.)
macro(flotilla_link_package package)
  cmake_parse_arguments(FLOTILLA_LINK "" "VERSION" "COMPONENTS;TARGETS" ${ARGN})
  set(FLOTILLA_LINK_ARGUMENTS ${package} ${FLOTILLA_LINK_VERSION})
  if(FLOTILLA_LINK_COMPONENTS)
    list(APPEND FLOTILLA_LINK_ARGUMENTS COMPONENTS ${FLOTILLA_LINK_COMPONENTS})
  endif()
  find_package(${FLOTILLA_LINK_ARGUMENTS} REQUIRED)
  target_link_libraries(flotilla PRIVATE ${FLOTILLA_LINK_TARGETS})
  list(JOIN FLOTILLA_LINK_ARGUMENTS " " FLOTILLA_LINK_ARGUMENTS)
  set_property(GLOBAL APPEND_STRING PROPERTY FLOTILLA_LINK_DEPENDENCIES "find_dependency(${FLOTILLA_LINK_ARGUMENTS})\n")
endmacro()

# Installs library, headers and package configuration; find_package(flotilla CONFIG) then gives flotilla::flotilla.
function(flotilla_install)
  include(CMakePackageConfigHelpers)
  set(folder "${CMAKE_INSTALL_LIBDIR}/cmake/flotilla")
  install(TARGETS flotilla EXPORT flotillaTargets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
  install(EXPORT flotillaTargets NAMESPACE flotilla:: DESTINATION "${folder}")
  set(FLOTILLA_FIND_DEPENDENCIES "")
  if(NOT BUILD_SHARED_LIBS)
    get_property(FLOTILLA_FIND_DEPENDENCIES GLOBAL PROPERTY FLOTILLA_LINK_DEPENDENCIES)
  endif()
  configure_package_config_file("${PROJECT_SOURCE_DIR}/scripts/cmake/flotillaConfig.cmake.in" flotillaConfig.cmake
    INSTALL_DESTINATION "${folder}")
  write_basic_package_version_file(flotillaConfigVersion.cmake COMPATIBILITY ${FLOTILLA_COMPATIBILITY})
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/flotillaConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/flotillaConfigVersion.cmake"
    DESTINATION "${folder}")
  install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/scripts/cmake/NOTICE.txt"
    "${PROJECT_SOURCE_DIR}/scripts/packaging/CITATION.cff"
    DESTINATION "${CMAKE_INSTALL_DOCDIR}")
  flotilla_install_pkg_config()
endfunction()

# For builds without CMake. Who links the static library needs what it is linked with; of the shared one that is private.
function(flotilla_install_pkg_config)
  set(folder "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
  file(RELATIVE_PATH FLOTILLA_PC_PREFIX "/prefix/${folder}" "/prefix")
  if(BUILD_SHARED_LIBS)
    set(FLOTILLA_PC_PRIVATE .private)
    set(FLOTILLA_PC_LIBS "")
  else()
    set(FLOTILLA_PC_PRIVATE "")
    set(FLOTILLA_PC_LIBS " ${OpenMP_CXX_FLAGS} -pthread")
  endif()
  configure_file("${PROJECT_SOURCE_DIR}/scripts/cmake/flotilla.pc.in" flotilla.pc @ONLY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/flotilla.pc" DESTINATION "${folder}")
endfunction()

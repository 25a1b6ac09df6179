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

# flotilla_add_library(target name): one of the libraries, flotilla::name in this tree and in the installed package.
function(flotilla_add_library target name)
  add_library(${target})
  add_library(flotilla::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION}
    SOVERSION ${FLOTILLA_SOVERSION}
    INSTALL_RPATH "$ORIGIN" # shared libraries find each other
    POSITION_INDEPENDENT_CODE ON
    VERIFY_INTERFACE_HEADER_SETS ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/src")
  target_link_libraries(${target} PUBLIC $<BUILD_INTERFACE:flotilla_checks>)
  target_link_libraries(${target} PRIVATE
    $<BUILD_INTERFACE:flotilla_warnings>
    $<BUILD_INTERFACE:flotilla_numerics>
    $<BUILD_INTERFACE:Eigen3::Eigen>
    $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
endfunction()

# flotilla_link_package(Package [VERSION v] TO library [COMPONENTS c...] TARGETS t...)
# Finds a package that a library needs at link time and links it privately. A program that links the installed static
# library needs it too, so the package configuration will look for it; headers never do. (A header-only dependency is
# linked with $<BUILD_INTERFACE:...> instead and leaves no trace in the package.)
macro(flotilla_link_package package)
  cmake_parse_arguments(FLOTILLA_LINK "" "VERSION;TO" "COMPONENTS;TARGETS" ${ARGN})
  set(FLOTILLA_LINK_ARGUMENTS ${package} ${FLOTILLA_LINK_VERSION})
  if(FLOTILLA_LINK_COMPONENTS)
    list(APPEND FLOTILLA_LINK_ARGUMENTS COMPONENTS ${FLOTILLA_LINK_COMPONENTS})
  endif()
  find_package(${FLOTILLA_LINK_ARGUMENTS} REQUIRED)
  target_link_libraries(${FLOTILLA_LINK_TO} PRIVATE ${FLOTILLA_LINK_TARGETS})
  list(JOIN FLOTILLA_LINK_ARGUMENTS " " FLOTILLA_LINK_ARGUMENTS)
  set_property(GLOBAL APPEND_STRING PROPERTY ${FLOTILLA_LINK_TO}_DEPENDENCIES
    "find_dependency(${FLOTILLA_LINK_ARGUMENTS})\n  ")
endmacro()

# The files of one library in the installed package; its targets are an export of their own, so that who asks for the
# core alone needs nothing of the rest.
function(flotilla_install_library target export)
  install(TARGETS ${target} EXPORT ${export}
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
  install(EXPORT ${export} NAMESPACE flotilla:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/flotilla")
endfunction()

# Installs libraries, headers and package configuration; find_package(flotilla CONFIG) then gives flotilla::flotilla and
# flotilla::core, with COMPONENTS core the latter alone.
function(flotilla_install)
  include(CMakePackageConfigHelpers)
  set(folder "${CMAKE_INSTALL_LIBDIR}/cmake/flotilla")
  flotilla_install_library(flotilla_core flotillaCoreTargets)
  if(NOT FLOTILLA_CORE_ONLY)
    flotilla_install_library(flotilla flotillaTargets)
  endif()
  set(FLOTILLA_FIND_CORE_DEPENDENCIES "")
  set(FLOTILLA_FIND_DEPENDENCIES "")
  if(NOT BUILD_SHARED_LIBS)
    get_property(FLOTILLA_FIND_CORE_DEPENDENCIES GLOBAL PROPERTY flotilla_core_DEPENDENCIES)
    get_property(FLOTILLA_FIND_DEPENDENCIES GLOBAL PROPERTY flotilla_DEPENDENCIES)
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

# For builds without CMake. Who links static libraries needs what they are linked with; of shared ones that is private.
function(flotilla_install_pkg_config)
  set(folder "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
  file(RELATIVE_PATH FLOTILLA_PC_PREFIX "/prefix/${folder}" "/prefix")
  if(BUILD_SHARED_LIBS)
    set(FLOTILLA_PC_PRIVATE .private)
    set(FLOTILLA_PC_ALSO "\nRequires.private: ")
    set(FLOTILLA_PC_LIBS "")
  else()
    set(FLOTILLA_PC_PRIVATE "")
    set(FLOTILLA_PC_ALSO ", ")
    set(FLOTILLA_PC_LIBS " ${OpenMP_CXX_FLAGS} -pthread")
  endif()
  set(files flotilla-core.pc)
  if(NOT FLOTILLA_CORE_ONLY)
    list(APPEND files flotilla.pc)
  endif()
  foreach(file IN LISTS files)
    configure_file("${PROJECT_SOURCE_DIR}/scripts/cmake/${file}.in" ${file} @ONLY)
    install(FILES "${CMAKE_CURRENT_BINARY_DIR}/${file}" DESTINATION "${folder}")
  endforeach()
endfunction()

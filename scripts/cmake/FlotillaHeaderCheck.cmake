# SPDX-License-Identifier: MIT
# Every header compiles alone. The public ones are compiled as an embedder sees them (CMake's own check of the header set).
# An internal one that is the first include of the source file of its name is compiled alone there; every other one gets a
# translation unit with the library's own options, which includes it twice; so do those of modules that a build may leave
# out. One more unit includes all public headers together. (Which header has such a source file is looked up when the
# build is configured.)

# flotilla_first_in_its_source(VARIABLE header): whether header.hpp, given from src, may be included twice and is the first
# include of header.cpp.
function(flotilla_first_in_its_source variable header)
  set(${variable} FALSE PARENT_SCOPE)
  string(REGEX REPLACE "\\.hpp$" ".cpp" source "${PROJECT_SOURCE_DIR}/src/${header}")
  file(STRINGS "${PROJECT_SOURCE_DIR}/src/${header}" guard REGEX "^#pragma once" LIMIT_COUNT 1)
  if(guard AND EXISTS "${source}" AND NOT header MATCHES "^(cli|mpi|python)/")
    file(STRINGS "${source}" first REGEX "^#include" LIMIT_COUNT 1)
    if(first STREQUAL "#include \"${header}\"")
      set(${variable} TRUE PARENT_SCOPE)
    endif()
  endif()
endfunction()

file(GLOB_RECURSE headers RELATIVE "${PROJECT_SOURCE_DIR}/src" CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/*.hpp")
if(NOT FLOTILLA_PYTHON)
  list(FILTER headers EXCLUDE REGEX "^python/")
endif()
set(header_units)
foreach(header IN LISTS headers)
  flotilla_first_in_its_source(first "${header}")
  if(first)
    continue()
  endif()
  string(MAKE_C_IDENTIFIER "${header}" name)
  set(unit "${PROJECT_BINARY_DIR}/header_check/${name}.cpp")
  file(CONFIGURE OUTPUT "${unit}" CONTENT "#include \"${header}\"\n#include \"${header}\"\n")
  list(APPEND header_units "${unit}")
  # A header named for an instruction set needs its flags.
  if(header MATCHES "avx512")
    set_source_files_properties("${unit}" PROPERTIES COMPILE_OPTIONS "${FLOTILLA_AVX512_FLAGS}")
  elseif(header MATCHES "avx2")
    set_source_files_properties("${unit}" PROPERTIES COMPILE_OPTIONS "${FLOTILLA_AVX2_FLAGS}")
  endif()
endforeach()

file(GLOB_RECURSE headers RELATIVE "${PROJECT_SOURCE_DIR}/include" CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/*.hpp")
list(TRANSFORM headers REPLACE "(.+)" "#include <\\1>\n")
list(JOIN headers "" includes)
set(unit "${PROJECT_BINARY_DIR}/header_check/all_public_headers.cpp")
file(CONFIGURE OUTPUT "${unit}" CONTENT "${includes}")
list(APPEND header_units "${unit}")

add_library(flotilla_header_check OBJECT ${header_units})
# -O0: the objects are thrown away. A header's functions are unused here, and that is not worth a warning.
target_compile_options(flotilla_header_check PRIVATE
  $<TARGET_PROPERTY:flotilla,COMPILE_OPTIONS> -O0 -Wno-unused-function)
target_compile_definitions(flotilla_header_check PRIVATE $<TARGET_PROPERTY:flotilla,COMPILE_DEFINITIONS>)
target_include_directories(flotilla_header_check PRIVATE
  $<TARGET_PROPERTY:flotilla,INCLUDE_DIRECTORIES> $<TARGET_PROPERTY:flotilla_core,INCLUDE_DIRECTORIES> "${PROJECT_SOURCE_DIR}/include")
target_compile_features(flotilla_header_check PRIVATE cxx_std_20)
if(FLOTILLA_PYTHON)
  target_link_libraries(flotilla_header_check PRIVATE pybind11::headers Python::Module)
endif()
set_target_properties(flotilla_header_check PROPERTIES CXX_CLANG_TIDY "")

add_custom_target(flotilla_public_header_check ALL)
add_dependencies(flotilla_public_header_check flotilla_verify_interface_header_sets)

# SPDX-License-Identifier: MIT
# Run at build time with -D source, input, output, version, compiler, flags: writes `output`, and touches it only when
# something changed, so that a build without a new commit recompiles nothing.
find_package(Git QUIET)
set(commit "")
if(Git_FOUND)
  execute_process(COMMAND "${GIT_EXECUTABLE}" describe --always --abbrev=40 --match=no-tag --dirty
    WORKING_DIRECTORY "${source}" OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT commit)
  set(commit "unknown")
endif()
configure_file("${input}" "${output}" @ONLY)

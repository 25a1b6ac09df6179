# SPDX-License-Identifier: MIT
# Tests that look at the source tree itself. Exit code 77 means skipped: the tool is not installed.
find_package(Python3 3.9 COMPONENTS Interpreter REQUIRED)

function(flotilla_add_check name)
  cmake_parse_arguments(ARG "" "" "COMMAND;LABELS" ${ARGN})
  add_test(NAME ${name} COMMAND ${ARG_COMMAND})
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" SKIP_RETURN_CODE 77)
endfunction()

flotilla_add_check(Sources.IncludesFollowTheModuleTable LABELS fast
  COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/scripts/check_sources.py" "${PROJECT_SOURCE_DIR}")
flotilla_add_check(Sources.PlantedIncludeViolationsAreFound LABELS fast
  COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/tests/check_sources_test.py")
flotilla_add_check(Sources.PagesPointToWhatIsThere LABELS fast
  COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/scripts/check_links.py" "${PROJECT_SOURCE_DIR}")
flotilla_add_check(Sources.PlantedDeadReferencesAreFound LABELS fast
  COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/tests/check_links_test.py")
flotilla_add_check(Sources.TheHouseIsMeasuredRight LABELS fast
  COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/tests/house_test.py")
flotilla_add_check(Sources.PlantedHeaderViolationsAreFound LABELS fast
  COMMAND "${PROJECT_SOURCE_DIR}/tests/header_check_test.sh" "${CMAKE_COMMAND}" "${CMAKE_CXX_COMPILER}")
flotilla_add_check(Sources.AreFormatted LABELS fast
  COMMAND "${PROJECT_SOURCE_DIR}/scripts/format" --check)
flotilla_add_check(Sources.PageOfSpeedIsWhatTheResultsGive LABELS fast
  COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/bench/scenarios/page" --check)

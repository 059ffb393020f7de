# One CMake target per room, behind walls: a source sees the headers of its own target and of those that the target links,
# and the compiler refuses any other (touchstone_wall; tried by the test ci.walls).
include(GoogleTest)

if(TOUCHSTONE_TIMEOUT_FACTOR STREQUAL "")
  set(TOUCHSTONE_TIMEOUT_FACTOR 1)
  if(TOUCHSTONE_SANITIZE)  # instrumented and hardly optimised, a step takes some ten times as long
    set(TOUCHSTONE_TIMEOUT_FACTOR 10)
  endif()
elseif(NOT TOUCHSTONE_TIMEOUT_FACTOR MATCHES "^[1-9][0-9]*$")
  message(FATAL_ERROR "TOUCHSTONE_TIMEOUT_FACTOR is '${TOUCHSTONE_TIMEOUT_FACTOR}': a whole number from 1 on was expected")
endif()

# Most of what compiling cost was parsing Eigen, fmt and JSON once more for each file. Rooms therefore share one precompiled
# header, and CMake compiles several files of a target as one unit (TOUCHSTONE_UNITY files, 0: each alone). The preset
# `tidy` has neither, so that clang-tidy finds a missing include.
if(TOUCHSTONE_UNITY GREATER 1)
  set(CMAKE_UNITY_BUILD ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE ${TOUCHSTONE_UNITY})
endif()
# nlohmann's header has a literal, operator "" _json, that nothing here uses. It is an inline function and no template, so that
# the compiler instantiates what it calls, the whole parser, in every unit: 0.6 s each. The precompiled headers take a
# copy of the header that only declares it; where its text is another, the header as it is.
function(touchstone_make_json_header folder)
  get_target_property(json_folder nlohmann_json::nlohmann_json INTERFACE_INCLUDE_DIRECTORIES)
  find_file(touchstone_json_header nlohmann/json.hpp PATHS ${json_folder} REQUIRED)
  mark_as_advanced(touchstone_json_header)
  file(READ ${touchstone_json_header} json_text)
  # Behind a directive (3.11.3, in Debian 13) the semicolon needs a line of its own.
  string(REPLACE "#endif\n{\n    return nlohmann::json::parse(s, s + n);\n}" "#endif\n;" json_text "${json_text}")
  string(REPLACE "\n{\n    return nlohmann::json::parse(s, s + n);\n}" ";" json_text "${json_text}")
  file(WRITE ${folder}/json.hpp.new "${json_text}")
  file(MAKE_DIRECTORY ${folder}/nlohmann)
  file(COPY_FILE ${folder}/json.hpp.new ${folder}/nlohmann/json.hpp ONLY_IF_DIFFERENT)
endfunction()

# Two of them: a unit is optimised as its precompiled header was, whatever its own level says. Rooms whose code runs once in a
# command, and not in each step of a renderer or each evaluation of a fit, are COLD: -O1, which takes a third less time to
# compile, and larger units. Results are the same to the bit at every level.
set(touchstone_pch_folder ${PROJECT_BINARY_DIR}/pch)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/room_pch.cc CONTENT "namespace touchstone {}\n")
add_library(touchstone_room_pch STATIC ${PROJECT_BINARY_DIR}/room_pch.cc)
add_library(touchstone_cold_room_pch STATIC ${PROJECT_BINARY_DIR}/room_pch.cc)
target_compile_options(touchstone_cold_room_pch PRIVATE $<$<CONFIG:Release>:-O1>)
function(touchstone_use_room_pch)
  touchstone_make_json_header(${touchstone_pch_folder})
  foreach(pch IN ITEMS touchstone_room_pch touchstone_cold_room_pch)
    target_link_libraries(${pch} PRIVATE touchstone_options Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json)
    target_include_directories(${pch} PRIVATE ${touchstone_pch_folder})
    touchstone_wall(${pch} PRIVATE harness/base/compiled_once.h)
    target_precompile_headers(${pch} PRIVATE <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <nlohmann/json.hpp>
      <harness/base/compiled_once.h> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory>
      <optional> <span> <sstream> <string> <string_view> <utility> <vector>)
  endforeach()
endfunction()

# touchstone_precompiled([COLD] <library>...) compiles static libraries with the rooms' precompiled header.
function(touchstone_precompiled)
  cmake_parse_arguments(ARG "COLD" "" "" ${ARGV})
  foreach(target IN LISTS ARG_UNPARSED_ARGUMENTS)
    if(ARG_COLD)
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
      target_precompile_headers(${target} REUSE_FROM touchstone_cold_room_pch)
      set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 16)
    else()
      target_precompile_headers(${target} REUSE_FROM touchstone_room_pch)
    endif()
  endforeach()
endfunction()

# Tests share one precompiled header: parsing GoogleTest, Eigen and JSON anew in each would double their build time.
if(BUILD_TESTING)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/test_pch.cc CONTENT "int main() {}\n")
  add_executable(touchstone_test_pch ${PROJECT_BINARY_DIR}/test_pch.cc)
endif()
function(touchstone_use_test_pch)
  target_link_libraries(touchstone_test_pch PRIVATE touchstone_options Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json GTest::gmock GTest::gtest)
  target_compile_options(touchstone_test_pch PRIVATE -O1)
  target_include_directories(touchstone_test_pch PRIVATE ${touchstone_pch_folder})
  touchstone_wall(touchstone_test_pch PRIVATE harness/base/compiled_once.h)
  target_precompile_headers(touchstone_test_pch PRIVATE <gmock/gmock.h> <gtest/gtest.h> <Eigen/Core> <Eigen/Geometry>
    <fmt/format.h> <nlohmann/json.hpp> <harness/base/compiled_once.h> <filesystem> <fstream> <functional> <optional> <string>
    <vector>)
endfunction()

# touchstone_wall(<target> PUBLIC|PRIVATE|INTERFACE header.h...): a folder of links to these headers, by their paths from the
# top of the tree, is an include directory of the target. The tree itself is none: what no link leads to cannot be included.
function(touchstone_wall target scope)
  set(wall ${PROJECT_BINARY_DIR}/walls/${target})
  if(scope STREQUAL "PRIVATE")
    string(APPEND wall ".private")
  endif()
  set(links "")
  foreach(header IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH header NORMALIZE OUTPUT_VARIABLE file)
    cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE path)
    cmake_path(GET path PARENT_PATH folder)
    file(MAKE_DIRECTORY ${wall}/${folder})
    file(CREATE_LINK ${file} ${wall}/${path} SYMBOLIC)
    list(APPEND links ${wall}/${path})
  endforeach()
  file(GLOB_RECURSE stale ${wall}/*)
  list(REMOVE_ITEM stale ${links})
  if(stale)
    file(REMOVE ${stale})
  endif()
  target_include_directories(${target} ${scope} $<BUILD_INTERFACE:${wall}>)
endfunction()

# touchstone_sees(<target> room...): the headers of rooms that the target does not link.
function(touchstone_sees target)
  foreach(room IN LISTS ARGN)
    target_include_directories(${target} PRIVATE ${PROJECT_BINARY_DIR}/walls/touchstone_${room})
  endforeach()
endfunction()

# touchstone_room_label(<variable>): the label of the room whose CMakeLists.txt calls, room/recording or room/renderers.
# CDash shows tests and compiler errors by it. It holds a slash, so that it is no other label's name.
function(touchstone_room_label variable)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REGEX REPLACE "^harness/" "" folder "${folder}")
  string(REGEX REPLACE "/.*" "" folder "${folder}")
  set(${variable} "room/${folder}" PARENT_SCOPE)
endfunction()

# touchstone_install_headers(<folder below include> <component> header.h...): by their paths from the top of the tree.
function(touchstone_install_headers below component)
  foreach(header IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH header NORMALIZE OUTPUT_VARIABLE file)
    cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE path)
    cmake_path(GET path PARENT_PATH folder)
    set(where DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${below}/${folder} COMPONENT ${component})
    if(component STREQUAL "internals")
      list(APPEND where EXCLUDE_FROM_ALL)
    endif()
    install(FILES ${file} ${where})
    if(NOT component STREQUAL "internals")
      set_property(GLOBAL APPEND PROPERTY TOUCHSTONE_DOORS ${path})
    endif()
  endforeach()
endfunction()

# touchstone_add_room(<name> SOURCES a.cc... [DOORS a.h...] [HEADERS a.h...] [PRIVATE_HEADERS a.h...] [DEPENDS room...]
#                     [LIBS target...] [PRIVATE_LIBS target...] [ALONE] [COLD])
# COLD: see touchstone_precompiled. ALONE: each file is a unit of its own, without the rooms' precompiled header.
# Makes the static library touchstone_<name> with alias touchstone::<name>. Headers are included by their path from the top
# of the tree. DOORS and HEADERS by what links the room: DOORS are for everybody, installed and promised (ci/doors); HEADERS
# are for the rooms of this tree and, installed apart as the component `internals`, for its extras. PRIVATE_HEADERS by the
# room's own sources alone. all_verify_interface_header_sets compiles each door and header alone.
function(touchstone_add_room name)
  cmake_parse_arguments(ARG "ALONE;COLD" "" "SOURCES;DOORS;HEADERS;PRIVATE_HEADERS;DEPENDS;LIBS;PRIVATE_LIBS" ${ARGN})
  set(target touchstone_${name})
  # For the package: what find_package must find for those who want this room (TouchstoneInstall.cmake).
  set_property(GLOBAL APPEND PROPERTY TOUCHSTONE_ROOMS ${name})
  set_property(GLOBAL PROPERTY TOUCHSTONE_ROOM_${name}_DEPENDS ${ARG_DEPENDS})
  set_property(GLOBAL PROPERTY TOUCHSTONE_ROOM_${name}_LIBS ${ARG_LIBS} ${ARG_PRIVATE_LIBS})
  if(ARG_SOURCES)
    add_library(${target} STATIC ${ARG_SOURCES})
    touchstone_room_label(label)
    set_property(TARGET ${target} PROPERTY LABELS ${label})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:touchstone_options>)
    if(ARG_ALONE)
      set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
    elseif(ARG_COLD)
      touchstone_precompiled(COLD ${target})
    else()
      touchstone_precompiled(${target})
    endif()
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  if(ARG_SOURCES AND BUILD_TESTING)  # for the test ci.walls
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/walls/${name}.includes
      CONTENT "$<JOIN:$<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>,\n>\n")
  endif()
  add_library(touchstone::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  touchstone_wall(${target} ${scope} ${ARG_DOORS} ${ARG_HEADERS})
  if(ARG_PRIVATE_HEADERS)
    touchstone_wall(${target} PRIVATE ${ARG_PRIVATE_HEADERS})
  endif()
  target_compile_features(${target} ${scope} cxx_std_20)
  foreach(room IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} ${scope} touchstone::${room})
  endforeach()
  target_link_libraries(${target} ${scope} ${ARG_LIBS})
  if(ARG_PRIVATE_LIBS)
    target_link_libraries(${target} PRIVATE ${ARG_PRIVATE_LIBS})
  endif()
  install(TARGETS ${target} EXPORT touchstoneTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/touchstone)
  touchstone_install_headers(touchstone development ${ARG_DOORS})
  touchstone_install_headers(touchstone-internals internals ${ARG_HEADERS})
  # Not in the package: what all_verify_interface_header_sets compiles, each header alone.
  set(headers ${ARG_DOORS} ${ARG_HEADERS})
  if(headers)
    add_library(${target}_headers INTERFACE EXCLUDE_FROM_ALL)
    list(TRANSFORM headers PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
    target_sources(${target}_headers INTERFACE FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR} FILES ${headers})
    target_link_libraries(${target}_headers INTERFACE ${target})
  endif()
endfunction()

# Which tests run at night alone: the first column of the table in docs/explanation/testing.md, as one regular expression, in
# TOUCHSTONE_BY_NIGHT and, for what ctest reads when it runs, in a file. Their labels: nightly and by_turns (.ci/run).
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/explanation/testing.md)
file(STRINGS ${PROJECT_SOURCE_DIR}/docs/explanation/testing.md TOUCHSTONE_BY_NIGHT REGEX "^. `\\^")
list(TRANSFORM TOUCHSTONE_BY_NIGHT REPLACE "^. `([^`]*)`.*" "\\1")
list(TRANSFORM TOUCHSTONE_BY_NIGHT REPLACE "\\\\\\|" "|")  # \| is how a table of Markdown writes it
list(JOIN TOUCHSTONE_BY_NIGHT "|" TOUCHSTONE_BY_NIGHT)
# GoogleTest's TempDir(): of each build folder its own, for everybody (tests run as another user), since many tests write files
# of one name. ctest makes it again when the machine has cleaned up.
string(MD5 touchstone_test_folder "${PROJECT_BINARY_DIR}")
string(SUBSTRING ${touchstone_test_folder} 0 8 touchstone_test_folder)
set(touchstone_test_folder /tmp/touchstone-tests-${touchstone_test_folder})
file(WRITE ${PROJECT_BINARY_DIR}/by_night.cmake "set(by_night [==[${TOUCHSTONE_BY_NIGHT}]==])
if(NOT IS_DIRECTORY ${touchstone_test_folder})
  execute_process(COMMAND mkdir -m 1777 ${touchstone_test_folder})
endif()
")

# touchstone_label_by_night(): the tests that the folder's CMakeLists.txt added itself.
function(touchstone_label_by_night)
  get_property(tests DIRECTORY PROPERTY TESTS)
  foreach(test IN LISTS tests)
    if(test MATCHES "${TOUCHSTONE_BY_NIGHT}")
      set_property(TEST ${test} APPEND PROPERTY LABELS nightly by_turns)
    endif()
  endforeach()
endfunction()

# touchstone_add_tests(<name> SOURCES a_test.cc... [LIBS target...] [LABELS unit...] [TIMEOUT seconds] [SERIAL]
#                      [ENVIRONMENT NAME=value...] [SHARDS n] [RUNS n] [ALONE] [HEADERS a_for_test.h...])
# HEADERS: those of tests, and private ones of rooms, that these tests include.
# ALONE: each file is a unit of its own, for tests whose unnamed namespaces have names in common.
# Makes the GoogleTest program touchstone_<name>_test and one ctest test per case, found when ctest runs; with SHARDS n
# parts of many cases each, for thousands of cases that cost less than the start of the program.
# RUNS n: the cases that run by day do so in n runs, the tests <name>.run_<i>_of_<n>, which ctest starts first; each case
# tells its outcome of there, or, if it is chosen without them or a run ended before it, runs by itself. For suites of cases
# that share nothing and cost less than the start of the program.
function(touchstone_add_tests name)
  cmake_parse_arguments(ARG "SERIAL;ALONE" "TIMEOUT;SHARDS;RUNS" "SOURCES;HEADERS;LIBS;LABELS;ENVIRONMENT" ${ARGN})
  if(NOT BUILD_TESTING)
    return()
  endif()
  set(target touchstone_${name}_test)
  add_executable(${target} ${ARG_SOURCES})
  if(ARG_HEADERS)
    touchstone_wall(${target} PRIVATE ${ARG_HEADERS})
  endif()
  target_link_libraries(${target} PRIVATE touchstone_options ${ARG_LIBS} Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json
    GTest::gmock GTest::gtest)
  if(ARG_RUNS)
    target_link_libraries(${target} PRIVATE touchstone_recorded_tests_main)
  else()
    target_link_libraries(${target} PRIVATE GTest::gtest_main)
  endif()
  target_compile_options(${target} PRIVATE -O1)
  target_precompile_headers(${target} REUSE_FROM touchstone_test_pch)
  if(ARG_ALONE)
    set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
  endif()
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  touchstone_room_label(label)
  list(APPEND ARG_LABELS ${label})
  set_property(TARGET ${target} PROPERTY LABELS ${label})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(ARG_SHARDS)
    touchstone_shard_tests(${target} PREFIX ${name} LABELS ${ARG_LABELS} TIMEOUT ${ARG_TIMEOUT} SHARDS ${ARG_SHARDS}
      ENVIRONMENT ${ARG_ENVIRONMENT})
  else()
    touchstone_discover_tests(${target} PREFIX ${name} LABELS ${ARG_LABELS} TIMEOUT ${ARG_TIMEOUT} SERIAL ${ARG_SERIAL} RUNS "${ARG_RUNS}"
      ENVIRONMENT ${ARG_ENVIRONMENT})
  endif()
endfunction()

# touchstone_shard_tests(<target> PREFIX p LABELS l... TIMEOUT seconds SHARDS n [ENVIRONMENT NAME=value...])
# The ctest tests p.1_of_n to p.n_of_n, each every n-th case of a GoogleTest program. A part without cases fails.
function(touchstone_shard_tests target)
  cmake_parse_arguments(ARG "" "PREFIX;TIMEOUT;SHARDS" "LABELS;ENVIRONMENT" ${ARGN})
  math(EXPR ARG_TIMEOUT "${TOUCHSTONE_TIMEOUT_FACTOR} * ${ARG_TIMEOUT}")
  math(EXPR last "${ARG_SHARDS} - 1")
  foreach(i RANGE ${last})
    math(EXPR number "${i} + 1")
    set(test ${ARG_PREFIX}.${number}_of_${ARG_SHARDS})
    add_test(NAME ${test} COMMAND ${target} --gtest_brief=1)
    touchstone_test_environment(environment ${ARG_ENVIRONMENT})
    set_tests_properties(${test} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT}
      ENVIRONMENT "${environment};GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${i}"
      FAIL_REGULAR_EXPRESSION " 0 tests from 0 test suites ran")
  endforeach()
endfunction()

# What every test finds in its environment: touchstone_test_environment(<variable> [NAME=value...])
function(touchstone_test_environment variable)
  set(${variable} "TEST_TMPDIR=${touchstone_test_folder}" "TOUCHSTONE_DATA_DIR=${TOUCHSTONE_DATA_DIR}" "TOUCHSTONE_SOURCE_DIR=${PROJECT_SOURCE_DIR}"
    "TOUCHSTONE_PROGRAM=${PROJECT_BINARY_DIR}/bin/touchstone" ${ARGN} PARENT_SCOPE)
endfunction()

# touchstone_discover_tests(<target> PREFIX p LABELS l... TIMEOUT seconds SERIAL bool [RUNS n] [ENVIRONMENT NAME=value...])
# One ctest test per case of a GoogleTest program, named p.Suite.Case. A program may be given twice under two prefixes.
# gtest_discover_tests splits lists among its PROPERTIES, so labels and environment are set by a file that ctest reads
# after the tests were found.
function(touchstone_discover_tests target)
  cmake_parse_arguments(ARG "" "PREFIX;TIMEOUT;SERIAL;RUNS" "LABELS;ENVIRONMENT" ${ARGN})
  set(list touchstone_tests_${ARG_PREFIX})
  set(results ${CMAKE_CURRENT_BINARY_DIR}/test-results/${ARG_PREFIX})
  if(ARG_RUNS)
    set_target_properties(${target} PROPERTIES CROSSCOMPILING_EMULATOR "${PROJECT_BINARY_DIR}/bin/touchstone-test-result;${results}")
    add_dependencies(${target} touchstone_test_result)
  endif()
  get_target_property(program_folder ${target} BINARY_DIR)
  set(program ${program_folder}/${target})
  math(EXPR ARG_TIMEOUT "${TOUCHSTONE_TIMEOUT_FACTOR} * ${ARG_TIMEOUT}")
  # A busy machine may take longer to list thousands of cases than the 5 s after which CMake gives up on all of them.
  # The name that a case has in its program, without the value behind it: of a value that GoogleTest cannot print that is its
  # bytes, which differ from run to run, so that a dashboard would take the test for a new one each time.
  gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 120 NO_PRETTY_VALUES TEST_PREFIX "${ARG_PREFIX}."
    TEST_LIST ${list} PROPERTIES TIMEOUT ${ARG_TIMEOUT} RUN_SERIAL ${ARG_SERIAL})
  touchstone_test_environment(environment ${ARG_ENVIRONMENT})
  set(runs "")
  if(ARG_RUNS)
    foreach(i RANGE 1 ${ARG_RUNS})
      list(APPEND runs ${ARG_PREFIX}.run_${i}_of_${ARG_RUNS})
    endforeach()
  endif()
  math(EXPR run_timeout "5 * ${ARG_TIMEOUT}")
  set(properties_file ${CMAKE_CURRENT_BINARY_DIR}/${list}_properties.cmake)
  file(CONFIGURE OUTPUT ${properties_file} @ONLY CONTENT [=[
include("@PROJECT_BINARY_DIR@/by_night.cmake")
set(others "")
foreach(test IN LISTS @list@)
  set(labels "@ARG_LABELS@")
  set(runs "@runs@")
  if(test MATCHES "${by_night}")
    list(APPEND labels nightly by_turns)
    set(runs "")
    string(REGEX REPLACE "^@ARG_PREFIX@[.]" ":" case "${test}")
    string(APPEND others "${case}")
  endif()
  set_tests_properties("${test}" PROPERTIES LABELS "${labels}" ENVIRONMENT "@environment@" DEPENDS "${runs}")
endforeach()
set(number 0)
foreach(run IN ITEMS @runs@)
  add_test(${run} "@program@" "--gtest_filter=-${others}" --gtest_brief=1 --gtest_also_run_disabled_tests)
  set_tests_properties(${run} PROPERTIES LABELS "@ARG_LABELS@" TIMEOUT @run_timeout@ FAIL_REGULAR_EXPRESSION " 0 tests from 0 test suites ran"
    ENVIRONMENT "@environment@;TOUCHSTONE_TEST_RESULTS=@results@;GTEST_TOTAL_SHARDS=@ARG_RUNS@;GTEST_SHARD_INDEX=${number}")
  math(EXPR number "${number} + 1")
endforeach()
]=])
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${properties_file})
endfunction()

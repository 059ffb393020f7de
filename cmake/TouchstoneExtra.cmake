# What the CMakeLists.txt of an extra needs: a project over the installed package, or a part of Touchstone's own build, where
# its warnings and precompiled headers hold too.
#
# touchstone_extra_library(<name> SOURCES a.cc... LIBS target... [PRIVATE_LIBS target...])
#   The static library <name>, which sees the folder of the extra. -O1: an extra parses, calls and writes; what computes long
#   is in the rooms.
# touchstone_extra_program(<name> COMMANDS first... SOURCES main.cc LIBS target... [FORMATS file.json])
#   The program touchstone-<first> under the name of each command (apps/extras.h). FORMATS: a table of the files that it reads and writes, for
#   `touchstone formats`.
# touchstone_add_tests(<name> SOURCES a_test.cc... LIBS target... [HEADERS a_for_test.h...] [LABELS l...] [TIMEOUT s]
#                      [ENVIRONMENT NAME=value...])
function(touchstone_extra_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS;PRIVATE_LIBS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${ARG_LIBS} PRIVATE ${ARG_PRIVATE_LIBS})
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_compile_options(${name} PRIVATE -O1)
  if(COMMAND touchstone_precompiled)
    target_link_libraries(${name} PRIVATE touchstone_options)
    touchstone_precompiled(COLD ${name})
  endif()
endfunction()

function(touchstone_extra_program name)
  cmake_parse_arguments(ARG "" "FORMATS" "COMMANDS;SOURCES;LIBS" ${ARGN})
  set(programs ${PROJECT_BINARY_DIR}/bin)
  file(MAKE_DIRECTORY ${programs})
  list(POP_FRONT ARG_COMMANDS first)
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_compile_options(${name} PRIVATE -O1)
  set_target_properties(${name} PROPERTIES OUTPUT_NAME touchstone-${first} RUNTIME_OUTPUT_DIRECTORY ${programs})
  install(TARGETS ${name} RUNTIME DESTINATION bin COMPONENT program)
  foreach(command IN LISTS ARG_COMMANDS)
    file(CREATE_LINK touchstone-${first} ${programs}/touchstone-${command} SYMBOLIC)
    install(FILES ${programs}/touchstone-${command} DESTINATION bin COMPONENT program)
  endforeach()
  if(ARG_FORMATS)
    set(formats ${PROJECT_BINARY_DIR}/share/touchstone/formats)
    file(MAKE_DIRECTORY ${formats})
    file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_FORMATS} ${formats}/${first}.json SYMBOLIC)
    install(FILES ${ARG_FORMATS} DESTINATION share/touchstone/formats RENAME ${first}.json COMPONENT program)
  endif()
  if(COMMAND touchstone_carry_commit)
    touchstone_carry_commit(${name})
  endif()
endfunction()

if(BUILD_TESTING AND NOT COMMAND touchstone_add_tests)
  find_package(GTest REQUIRED)
  include(GoogleTest)
  function(touchstone_add_tests name)
    cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;HEADERS;LIBS;LABELS;ENVIRONMENT" ${ARGN})
    set(target touchstone_${name}_test)
    add_executable(${target} ${ARG_SOURCES})
    target_compile_features(${target} PRIVATE cxx_std_20)
    target_link_libraries(${target} PRIVATE ${ARG_LIBS} touchstone::testing GTest::gmock GTest::gtest_main)
    gtest_discover_tests(${target} TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST PROPERTIES LABELS "${ARG_LABELS}"
      TIMEOUT ${ARG_TIMEOUT}
      ENVIRONMENT "TOUCHSTONE_PROGRAM=$<TARGET_FILE:touchstone::program>;PATH=${PROJECT_BINARY_DIR}/bin:$ENV{PATH};${ARG_ENVIRONMENT}")
  endfunction()
endif()

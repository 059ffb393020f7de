# touchstone_add_renderer_tests(TARGET <target> RENDERER <name>
#   [ENTRY <function> HEADER <header>]
#   [PARAMETERS name=value...] [STIFFNESS N/m] [FRICTION coefficient] [TIP_RADIUS m] [EPSILON m]
#   [GOLDEN_LIKE <model> [GOLDEN_CASES case...] [VERDICT exact|felt]] [GOLDEN_DIR folder]
#   [PREFIX prefix] [LABELS label...])
#
# Gives a renderer outside Touchstone's tree the conformance and golden suite, as tests of your own ctest. The target is
#   - a plug-in (a MODULE or SHARED library with the functions of <touchstone/plugin.h>), or
#   - with ENTRY, a library with a C++ class: ENTRY is a function that returns its touchstone::RendererEntry, declared in
#     HEADER. A plug-in <target>_plugin is then made of it, which `touchstone --plugin` takes too. For it find_package needs
#     the component plugin.
# RENDERER is the renderer's name as model files spell it.
#
# Tests, each with the labels:
#   <prefix>.conformance.<Test>.<shape>   every test of harness/testing/renderer_conformance.h on every shape. PARAMETERS are
#                                         set; STIFFNESS is the steepest rise of force with depth where the renderer has no
#                                         parameter stiffness_N_per_m; FRICTION the largest tangential over normal force;
#                                         EPSILON a length below which the renderer tells nothing apart.
#                                         What the renderer declares it cannot do is skipped and shown as such, and so are
#                                         the faults of ALLOW, which are known (their names: touchstone scorecard).
#   <prefix>.loop                         if touchstone-loop is installed: on a device with enough viscous friction the renderer
#                                         is stable in a hand below Colgate and Schenkel's limit. Skipped without a parameter
#                                         stiffness_N_per_m.
#   <prefix>.golden.<case>                GOLDEN_LIKE: the bundled golden cases that have this model (all, or GOLDEN_CASES), with
#                                         the renderer in place of the model's own: it must give the same within tolerance, or
#                                         with VERDICT felt be off the right answer by less than a person notices, EPSILON
#                                         allowed. What the renderer declares it cannot do is skipped here too.
#   <prefix>.golden.<case>.<model>        GOLDEN_DIR: golden cases of your own. A first result is looked at and accepted with
#                                         touchstone golden accept.
# PREFIX is the renderer's name where it is not given.
function(touchstone_add_renderer_tests)
  cmake_parse_arguments(ARG "" "TARGET;RENDERER;ENTRY;HEADER;STIFFNESS;FRICTION;TIP_RADIUS;EPSILON;GOLDEN_LIKE;VERDICT;GOLDEN_DIR;PREFIX"
    "PARAMETERS;GOLDEN_CASES;ALLOW;LABELS" ${ARGN})
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "touchstone_add_renderer_tests: ${ARG_UNPARSED_ARGUMENTS} are no arguments of it")
  endif()
  foreach(required IN ITEMS TARGET RENDERER)
    if(NOT ARG_${required})
      message(FATAL_ERROR "touchstone_add_renderer_tests: ${required} is missing")
    endif()
  endforeach()
  if(NOT TARGET ${ARG_TARGET})
    message(FATAL_ERROR "touchstone_add_renderer_tests: there is no target ${ARG_TARGET}")
  endif()
  if(NOT TARGET touchstone::conformance)
    message(FATAL_ERROR "touchstone_add_renderer_tests: this touchstone was built with TOUCHSTONE_BUILD_CONFORMANCE=OFF; it has no touchstone-conformance")
  endif()
  if(NOT ARG_PREFIX)
    set(ARG_PREFIX ${ARG_RENDERER})
  endif()

  set(plugin ${ARG_TARGET})
  if(ARG_ENTRY)
    if(NOT ARG_HEADER)
      message(FATAL_ERROR "touchstone_add_renderer_tests: ENTRY ${ARG_ENTRY} needs the HEADER that declares it")
    endif()
    if(NOT TARGET touchstone::plugin)
      message(FATAL_ERROR "touchstone_add_renderer_tests: ENTRY needs find_package(touchstone COMPONENTS plugin)")
    endif()
    set(plugin ${ARG_TARGET}_plugin)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${plugin}.cc)
    file(CONFIGURE OUTPUT ${source} CONTENT
      "#include \"@ARG_HEADER@\"\n\n#include \"harness/plugin/plugin_export.h\"\n\nTOUCHSTONE_EXPORT_RENDERERS(@ARG_ENTRY@());\n" @ONLY)
    add_library(${plugin} MODULE ${source})
    # A static library goes into the plug-in as it is.
    set_target_properties(${ARG_TARGET} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${plugin} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
    target_link_libraries(${plugin} PRIVATE ${ARG_TARGET} touchstone::plugin)
  else()
    get_target_property(type ${ARG_TARGET} TYPE)
    if(NOT type MATCHES "^(MODULE|SHARED)_LIBRARY$")
      message(FATAL_ERROR "touchstone_add_renderer_tests: ${ARG_TARGET} is a ${type}; a plug-in is a MODULE or SHARED library, and a C++ class needs ENTRY and HEADER")
    endif()
  endif()

  # Golden cases are tests of their own, below.
  set(arguments --plugin=$<TARGET_FILE:${plugin}> --renderer=${ARG_RENDERER} --no-cases)
  foreach(parameter IN LISTS ARG_PARAMETERS)
    list(APPEND arguments --parameter=${parameter})
  endforeach()
  foreach(fault IN LISTS ARG_ALLOW)
    list(APPEND arguments --allow=${fault})
  endforeach()
  foreach(fact IN ITEMS STIFFNESS FRICTION TIP_RADIUS EPSILON)
    if(DEFINED ARG_${fact})
      string(TOLOWER ${fact} option)
      string(REPLACE "_" "-" option ${option})
      list(APPEND arguments --${option}=${ARG_${fact}})
    endif()
  endforeach()
  _touchstone_add_conformance_tests("${ARG_PREFIX}" "${ARG_LABELS}" "${arguments}")

  _touchstone_add_loop_test(${ARG_PREFIX} ${ARG_RENDERER} ${plugin} "${ARG_LABELS}")

  if(DEFINED ARG_VERDICT AND NOT ARG_VERDICT MATCHES "^(exact|felt)$")
    message(FATAL_ERROR "touchstone_add_renderer_tests: VERDICT ${ARG_VERDICT} is none; it is exact or felt")
  endif()
  set(verdict "")
  if(ARG_VERDICT STREQUAL felt)
    set(verdict --verdict felt)
    if(DEFINED ARG_EPSILON)
      list(APPEND verdict --epsilon ${ARG_EPSILON})
    endif()
  endif()

  if(ARG_GOLDEN_LIKE)
    set(bundled ${touchstone_DATA_DIR}/golden)
    _touchstone_golden_cases(${bundled} cases)
    set(added "")
    foreach(case IN LISTS cases)
      _touchstone_models_of(${bundled}/${case}/case.json models)
      if(ARG_GOLDEN_LIKE IN_LIST models AND (NOT ARG_GOLDEN_CASES OR case IN_LIST ARG_GOLDEN_CASES))
        _touchstone_add_golden_test(${ARG_PREFIX} ${ARG_PREFIX}.golden.${case} ${bundled} ${case} ${ARG_GOLDEN_LIKE} ${plugin} "${ARG_LABELS}"
          --renderer ${ARG_RENDERER} ${verdict})
        list(APPEND added ${case})
      endif()
    endforeach()
    list(REMOVE_ITEM ARG_GOLDEN_CASES ${added})
    if(NOT added OR ARG_GOLDEN_CASES)
      message(FATAL_ERROR "touchstone_add_renderer_tests: no bundled golden case ${ARG_GOLDEN_CASES} has the model ${ARG_GOLDEN_LIKE}; see ${bundled}")
    endif()
  endif()
  if(ARG_GOLDEN_DIR)
    get_filename_component(own ${ARG_GOLDEN_DIR} ABSOLUTE)
    _touchstone_golden_cases(${own} cases)
    if(NOT cases)
      message(FATAL_ERROR "touchstone_add_renderer_tests: ${own} has no golden case (a folder with case.json)")
    endif()
    foreach(case IN LISTS cases)
      _touchstone_models_of(${own}/${case}/case.json models)
      foreach(model IN LISTS models)
        _touchstone_add_golden_test(${ARG_PREFIX} ${ARG_PREFIX}.golden.${case}.${model} ${own} ${case} ${model} ${plugin} "${ARG_LABELS}")
      endforeach()
    endforeach()
  endif()
endfunction()

# One test per test and shape, asked of the program when ctest runs: the plug-in is built by then. Their outcomes come from
# a few runs of the whole suite, the tests <prefix>.conformance.run_<i>_of_<n>, which ctest starts first; a test that is
# chosen without them runs by itself.
function(_touchstone_add_conformance_tests prefix labels arguments)
  set(program $<TARGET_FILE:touchstone::conformance>)
  set(result $<TARGET_FILE:touchstone::test_result>)
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${prefix}_conformance_tests.cmake)
  set(results ${CMAKE_CURRENT_BINARY_DIR}/conformance-results/${prefix})
  file(GENERATE OUTPUT ${script} CONTENT "set(program \"${program}\")
set(result \"${result}\")
set(arguments \"${arguments}\")
set(labels \"${labels}\")
execute_process(COMMAND \"\${program}\" \${arguments} --gtest_list_tests OUTPUT_VARIABLE listed ERROR_QUIET RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  # Run as it is, the program says what is wrong, and the test fails.
  add_test(${prefix}.conformance \"\${program}\" \${arguments})
  set_tests_properties(${prefix}.conformance PROPERTIES LABELS \"\${labels}\")
  return()
endif()
set(runs \"\")
foreach(i RANGE 3)
  math(EXPR number \"\${i} + 1\")
  set(name ${prefix}.conformance.run_\${number}_of_4)
  add_test(\${name} \"\${program}\" \${arguments} \"--results=${results}\" --gtest_brief=1)
  set_tests_properties(\${name} PROPERTIES LABELS \"\${labels}\" TIMEOUT 1800
    ENVIRONMENT \"GTEST_TOTAL_SHARDS=4;GTEST_SHARD_INDEX=\${i}\")
  list(APPEND runs \${name})
endforeach()
string(REGEX REPLACE \"[;]\" \"\" listed \"\${listed}\")
string(REPLACE \"\\n\" \";\" listed \"\${listed}\")
foreach(line IN LISTS listed)
  if(line MATCHES \"^([A-Za-z_0-9/]+)[.]\")
    set(suite \${CMAKE_MATCH_1})
  elseif(line MATCHES \"^  ([A-Za-z_0-9]+)/([A-Za-z_0-9]+)\")
    set(test \${CMAKE_MATCH_1}/\${CMAKE_MATCH_2})
    set(name ${prefix}.conformance.\${CMAKE_MATCH_1}.\${CMAKE_MATCH_2})
    add_test(\${name} \"\${result}\" \"${results}\" \"\${program}\" \${arguments} \"--gtest_filter=\${suite}.\${test}\")
    set_tests_properties(\${name} PROPERTIES LABELS \"\${labels}\" TIMEOUT 300 SKIP_REGULAR_EXPRESSION \"\\\\[  SKIPPED \\\\]\"
      DEPENDS \"\${runs}\")
  endif()
endforeach()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
endfunction()

# Whether the extra stands beside the program is known when ctest runs.
function(_touchstone_add_loop_test prefix renderer plugin labels)
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${prefix}_loop_test.cmake)
  file(GENERATE OUTPUT ${script} CONTENT "if(EXISTS \"$<TARGET_FILE_DIR:touchstone::program>/touchstone-loop\")
  add_test(${prefix}.loop \"$<TARGET_FILE:touchstone::program>\" loop atlas \"--plugin=$<TARGET_FILE:${plugin}>\" --renderer=${renderer}
    --case \"passive plane\")
  set_tests_properties(${prefix}.loop PROPERTIES TIMEOUT 300 LABELS \"${labels}\" SKIP_RETURN_CODE 77)
endif()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
endfunction()

function(_touchstone_golden_cases folder result)
  file(GLOB files CONFIGURE_DEPENDS RELATIVE ${folder} ${folder}/*/case.json)
  list(TRANSFORM files REPLACE "/case.json$" "")
  set(${result} ${files} PARENT_SCOPE)
endfunction()

function(_touchstone_models_of file result)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})  # a model that comes later is tested, too
  file(READ ${file} text)
  string(JSON count ERROR_VARIABLE problem LENGTH "${text}" models)
  if(problem OR count LESS 1)
    message(FATAL_ERROR "${file}: no models: ${problem}")
  endif()
  set(models "")
  math(EXPR last "${count} - 1")
  foreach(i RANGE ${last})
    string(JSON model MEMBER "${text}" models ${i})
    list(APPEND models ${model})
  endforeach()
  set(${result} ${models} PARENT_SCOPE)
endfunction()

# What a failure leaves behind is the renderer's own: another's pass on the same case leaves it alone.
function(_touchstone_add_golden_test prefix name folder case model plugin labels)
  add_test(NAME ${name} COMMAND touchstone::program check ${case} --model ${model} --golden ${folder}
    --out ${CMAKE_CURRENT_BINARY_DIR}/golden-failures/${prefix} --plugin $<TARGET_FILE:${plugin}>
    --plugin-source ${CMAKE_CURRENT_SOURCE_DIR} ${ARGN} --ctest)
  set_tests_properties(${name} PROPERTIES TIMEOUT 300 LABELS "${labels}" SKIP_RETURN_CODE 77)
endfunction()

# The outbox: what a dashboard run produced, kept until a server has it. One folder per build in
# <binary>/dashboard-outbox: Testing/ as ctest wrote it, notes/, and what was tried so far in sent/ (harness/report/cdash_delivery.h).

# outbox_keep(VARIABLE): copies the results of the current run there and sets VARIABLE to the folder. Each run has its own: its
# stamp says the second.
function(outbox_keep variable)
  file(STRINGS "${CTEST_BINARY_DIRECTORY}/Testing/TAG" tag)
  list(GET tag 0 stamp)
  list(GET tag 1 group)
  string(MD5 name "${CTEST_SITE} ${CTEST_BUILD_NAME}")
  string(SUBSTRING "${name}" 0 8 name)
  set(entry "${CTEST_BINARY_DIRECTORY}/dashboard-outbox/${stamp}-${group}-${name}")
  file(REMOVE_RECURSE "${entry}.part")
  file(MAKE_DIRECTORY "${entry}.part/Testing")
  file(COPY "${CTEST_BINARY_DIRECTORY}/Testing/TAG" "${CTEST_BINARY_DIRECTORY}/Testing/${stamp}" DESTINATION "${entry}.part/Testing")
  # ctest sends what ran under valgrind as test results once more, which a server adds to the rows it has of the same tests.
  file(REMOVE "${entry}.part/Testing/${stamp}/DynamicAnalysis-Test.xml" "${entry}.part/Testing/${stamp}/Notes.xml")
  foreach(file IN LISTS CTEST_NOTES_FILES)
    file(COPY "${file}" DESTINATION "${entry}.part/notes")
  endforeach()
  file(RENAME "${entry}.part" "${entry}")
  set(${variable} "${entry}" PARENT_SCOPE)
endfunction()

# outbox_send(ENTRY CHECKOUT VARIABLE): delivers what the outbox holds; VARIABLE is empty when nothing is left. `touchstone
# dashboard send` does it; if this run built none and no other is at hand, ctest sends this run once, as well as it can
# (dashboard_submit.cmake), and the next run's program makes sure of it.
function(outbox_send entry checkout variable)
  set(${variable} TRUE PARENT_SCOPE)
  if("$ENV{TOUCHSTONE_CDASH_URL}" STREQUAL "")
    message("dashboard: no server is set (TOUCHSTONE_CDASH_URL); the results are kept in ${entry}")
    return()
  endif()
  unset(program)  # find_program() looks for nothing if it is set, be it empty (CMP0125)
  if(NOT "$ENV{TOUCHSTONE_DASHBOARD_PROGRAM}" STREQUAL "")
    set(program "$ENV{TOUCHSTONE_DASHBOARD_PROGRAM}" dashboard)
  else()
    # The extra itself: a build that broke may have `touchstone` without it.
    find_program(program touchstone-dashboard PATHS "${CTEST_BINARY_DIRECTORY}/bin" "${checkout}/build/default/bin"
      "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../../bin" NO_DEFAULT_PATH)
    find_program(program touchstone-dashboard)
  endif()
  if(program)
    set(patience "")
    if(NOT "$ENV{TOUCHSTONE_DASHBOARD_WAIT}" STREQUAL "")
      set(patience --wait "$ENV{TOUCHSTONE_DASHBOARD_WAIT}")
    endif()
    execute_process(COMMAND ${program} send "${CTEST_BINARY_DIRECTORY}" ${patience} RESULT_VARIABLE unsent)
  else()
    message("dashboard: no touchstone-dashboard is at hand: ctest sends this run, and nothing reads it back")
    set(ENV{TOUCHSTONE_DASHBOARD_SOURCE} "${CTEST_SOURCE_DIRECTORY}")
    execute_process(COMMAND "${CTEST_EXECUTABLE_NAME}" -S "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/dashboard_submit.cmake,${entry}"
      RESULT_VARIABLE unsent)
  endif()
  if(unsent EQUAL 0)
    set(unsent "")
  endif()
  set(${variable} "${unsent}" PARENT_SCOPE)
endfunction()

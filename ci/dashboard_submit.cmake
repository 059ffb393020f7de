# Sends one entry of the outbox by ctest itself, for runs without a touchstone program (the build failed, on a fresh machine).
# Run by dashboard_outbox.cmake as  ctest -S ci/dashboard_submit.cmake,ENTRY.
#
# Each part is sent at most once, Done last, and none once ctest calls one failed. It takes any HTTP 200 for a success, the
# log-in page of a proxy too, and logs no answer. So the entry is kept, with what was tried in sent/, and `touchstone dashboard
# send` reads it back later and sends what the server does not show.
cmake_minimum_required(VERSION 3.25)
set(CTEST_RUN_CURRENT_SCRIPT FALSE)  # else ctest would look for its own settings after the script
set(entry "${CTEST_SCRIPT_ARG}")

file(STRINGS "${entry}/Testing/TAG" tag)
list(GET tag 0 stamp)
list(GET tag 1 group)
file(GLOB results "${entry}/Testing/${stamp}/*.xml")
foreach(file IN LISTS results)
  file(STRINGS "${file}" site REGEX "<Site |BuildName=|[ \t]Name=" LIMIT_COUNT 3)
  if(site MATCHES "BuildName=\"([^\"]*)\"")
    set(CTEST_BUILD_NAME "${CMAKE_MATCH_1}")
  endif()
  if(site MATCHES "[ \t;]Name=\"([^\"]*)\"")
    set(CTEST_SITE "${CMAKE_MATCH_1}")
  endif()
endforeach()
set(CTEST_BINARY_DIRECTORY "${entry}")
set(CTEST_SOURCE_DIRECTORY "${CMAKE_CURRENT_LIST_DIR}/..")
if(NOT EXISTS "${CTEST_SOURCE_DIRECTORY}/CTestConfig.cmake")  # installed
  set(CTEST_SOURCE_DIRECTORY "$ENV{TOUCHSTONE_DASHBOARD_SOURCE}")
endif()
include("${CTEST_SOURCE_DIRECTORY}/CTestConfig.cmake")

# The token's header, from the environment or a file, never from the command line.
set(token "$ENV{TOUCHSTONE_CDASH_TOKEN}")
if(NOT token AND NOT "$ENV{TOUCHSTONE_CDASH_TOKEN_FILE}" STREQUAL "")
  file(STRINGS "$ENV{TOUCHSTONE_CDASH_TOKEN_FILE}" token LIMIT_COUNT 1)
endif()
set(header "")
if(token)
  set(header HTTPHEADER "Authorization: Bearer ${token}")
endif()

set(model "${group}")
if(NOT model MATCHES "^(Experimental|Continuous|Nightly)$")
  set(model Experimental)
endif()
ctest_start(${model} GROUP ${group} APPEND QUIET)
file(GLOB CTEST_NOTES_FILES "${entry}/notes/*")

# submit_once(PART): sends it unless it was, and stops the script when the answer is not OK.
function(submit_once part)
  if(EXISTS "${entry}/sent/${part}")
    return()
  endif()
  file(WRITE "${entry}/sent/${part}" "unknown\n")
  file(GLOB logs "${entry}/Testing/Temporary/LastSubmit*.log")
  file(REMOVE ${logs} "${entry}/none")
  ctest_submit(PARTS ${part} SUBMIT_URL "${CTEST_SUBMIT_URL}" ${header} RETRY_COUNT 0 RETURN_VALUE status CAPTURE_CMAKE_ERROR error
    QUIET)
  set(answer "")
  file(GLOB logs "${entry}/Testing/Temporary/LastSubmit*.log")
  foreach(log IN LISTS logs)
    file(READ "${log}" text)
    string(APPEND answer "${text}")
  endforeach()
  if(status OR error OR answer MATCHES "[Ee]rror message was")
    string(REGEX MATCH "[Ee]rror message was: ([^\n]*)" why "${answer}")
    message("dashboard: ${part} was not taken: ${CMAKE_MATCH_1}\ndashboard: the results are kept in ${entry}; send them later: touchstone dashboard send")
    message(FATAL_ERROR "dashboard: ${entry} could not be submitted")
  endif()
endfunction()

foreach(part_file IN ITEMS Update=Update Configure=Configure Build=Build Test=Test Coverage=Coverage MemCheck=DynamicAnalysis Upload=Upload)
  string(REPLACE "=" ";" part_file "${part_file}")
  list(GET part_file 0 part)
  list(GET part_file 1 file)
  if(part STREQUAL Upload AND CTEST_NOTES_FILES)
    submit_once(Notes)
  endif()
  if(EXISTS "${entry}/Testing/${stamp}/${file}.xml")
    submit_once(${part})
  endif()
endforeach()
submit_once(Done)
message("dashboard: sent, not read back; kept in ${entry} until touchstone dashboard send finds it on the server")

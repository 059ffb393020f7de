# Where results go: read by `include(CTest)` and by ctest's scripts. Server, project and token come from the environment
# or the cache; nothing about a server stands in this tree. The token is no part of this file at all: only the submission
# itself (ci/dashboard_submit.cmake) reads it, from TOUCHSTONE_CDASH_TOKEN or the file TOUCHSTONE_CDASH_TOKEN_FILE.
#   TOUCHSTONE_CDASH_URL      https://cdash.example.org
#   TOUCHSTONE_CDASH_PROJECT  defaults to Touchstone
foreach(name IN ITEMS URL PROJECT)
  if(NOT TOUCHSTONE_CDASH_${name})
    set(TOUCHSTONE_CDASH_${name} "$ENV{TOUCHSTONE_CDASH_${name}}")
  endif()
endforeach()
if(NOT TOUCHSTONE_CDASH_PROJECT)
  set(TOUCHSTONE_CDASH_PROJECT Touchstone)
endif()
set(CTEST_PROJECT_NAME "${TOUCHSTONE_CDASH_PROJECT}")
set(CTEST_NIGHTLY_START_TIME "01:00:00 UTC")
if(TOUCHSTONE_CDASH_URL)
  set(CTEST_SUBMIT_URL "${TOUCHSTONE_CDASH_URL}/submit.php?project=${TOUCHSTONE_CDASH_PROJECT}")
else()
  # Nowhere: a submission without TOUCHSTONE_CDASH_URL is refused by the scripts before anything is sent.
  set(CTEST_SUBMIT_URL "")
endif()
set(CTEST_DROP_SITE_CDASH TRUE)

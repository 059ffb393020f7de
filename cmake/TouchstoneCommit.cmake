# The commit that a program was built from, asked of git at every build. The file changes only when the answer does, and
# only the programs that carry it are linked again.
# As a script (cmake -DOUT=file -DSOURCE=folder -P TouchstoneCommit.cmake) it writes that file.
if(CMAKE_SCRIPT_MODE_FILE)
  set(commit unknown)
  set(dirty false)
  find_package(Git QUIET)
  if(GIT_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse HEAD WORKING_DIRECTORY ${SOURCE}
      OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
    if(status EQUAL 0)
      set(commit ${head})
      execute_process(COMMAND ${GIT_EXECUTABLE} status --porcelain WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE changes ERROR_QUIET)
      if(changes)
        set(dirty true)
      endif()
    endif()
  endif()
  file(CONFIGURE OUTPUT "${OUT}" CONTENT [=[
#include "harness/base/version.h"

namespace touchstone {

SourceState source_state() { return {"@commit@", @dirty@}; }

}  // namespace touchstone
]=] @ONLY)
  return()
endif()

# touchstone_carry_commit(<program>): build_info() in it tells commit and changes as they were when it was linked.
function(touchstone_carry_commit program)
  if(NOT TARGET touchstone_commit)
    set(file ${PROJECT_BINARY_DIR}/commit.cc)
    add_custom_target(touchstone_ask_commit BYPRODUCTS ${file}
      COMMAND ${CMAKE_COMMAND} -DOUT=${file} -DSOURCE=${PROJECT_SOURCE_DIR} -P ${CMAKE_CURRENT_FUNCTION_LIST_FILE}
      COMMENT "Asking git for the commit")
    add_library(touchstone_commit OBJECT ${file})
    add_dependencies(touchstone_commit touchstone_ask_commit)
    target_link_libraries(touchstone_commit PRIVATE touchstone_options touchstone::base)
  endif()
  target_sources(${program} PRIVATE $<TARGET_OBJECTS:touchstone_commit>)
endfunction()

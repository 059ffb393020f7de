# Before anything is installed: where only the program was built, only the program is installed, instead of half a package
# and an error. Included before the rooms, since install rules run in the order in which they stand.
# TouchstoneInstall.cmake writes the list of what a whole package holds.
set(TOUCHSTONE_INSTALLED_FILES ${PROJECT_BINARY_DIR}/installed_files.txt)
install(CODE [=[
  if(NOT CMAKE_INSTALL_COMPONENT)
    file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/installed_files.txt" artefacts)
    set(missing "")
    foreach(artefact IN LISTS artefacts)
      if(NOT EXISTS "${artefact}")
        list(APPEND missing "${artefact}")
      endif()
    endforeach()
    list(LENGTH missing count)
    if(count GREATER 0)
      list(GET missing 0 first)
      message(STATUS "${count} files of the library are not built (the first: ${first}): only the program is installed. "
        "For the library too: cmake --build \"${CMAKE_CURRENT_LIST_DIR}\", then install again.")
      set(CMAKE_INSTALL_COMPONENT program)
    endif()
  endif()
]=] ALL_COMPONENTS)

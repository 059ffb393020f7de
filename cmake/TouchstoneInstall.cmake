# Install and export: find_package(touchstone) works from another folder, and from another place than it was installed to.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/touchstone)
set(TOUCHSTONE_INSTALL_DATADIR ${CMAKE_INSTALL_DATADIR}/touchstone)
set(TOUCHSTONE_INTERNALS_DIR ${CMAKE_INSTALL_INCLUDEDIR}/touchstone-internals)

# What each room needs, for the components of the package.
get_property(rooms GLOBAL PROPERTY TOUCHSTONE_ROOMS)
file(READ ${CMAKE_CURRENT_LIST_DIR}/touchstoneDependencies.cmake known_libraries)
set(TOUCHSTONE_ROOM_TABLE "set(_touchstone_rooms ${rooms})\n")
foreach(room IN LISTS rooms)
  get_property(depends GLOBAL PROPERTY TOUCHSTONE_ROOM_${room}_DEPENDS)
  get_property(libraries GLOBAL PROPERTY TOUCHSTONE_ROOM_${room}_LIBS)
  foreach(library IN LISTS libraries)
    string(FIND "${known_libraries}" "\"${library}\"" at)
    if(at EQUAL -1)
      message(FATAL_ERROR "the room ${room} links ${library}: say in cmake/touchstoneDependencies.cmake which package that is")
    endif()
  endforeach()
  string(APPEND TOUCHSTONE_ROOM_TABLE
    "set(_touchstone_${room}_depends ${depends})\nset(_touchstone_${room}_libs ${libraries})\n")
endforeach()

install(EXPORT touchstoneTargets NAMESPACE touchstone:: DESTINATION ${package_dir})
configure_package_config_file(cmake/touchstoneConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/touchstoneConfig.cmake
  INSTALL_DESTINATION ${package_dir} PATH_VARS TOUCHSTONE_INSTALL_DATADIR TOUCHSTONE_INTERNALS_DIR)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/touchstoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/touchstoneConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/touchstoneConfigVersion.cmake
  cmake/touchstoneDependencies.cmake cmake/TouchstoneExtra.cmake cmake/TouchstoneRendererTests.cmake DESTINATION ${package_dir})

# The headers that are installed and promised, for the test ci.doors.
get_property(doors GLOBAL PROPERTY TOUCHSTONE_DOORS)
list(JOIN doors "\n" doors)
file(WRITE ${PROJECT_BINARY_DIR}/doors.txt "${doors}\n")

# What a whole package holds, for TouchstoneInstallGuard.cmake.
set(artefacts "")
foreach(room IN LISTS rooms)
  get_target_property(type touchstone_${room} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    string(APPEND artefacts "$<TARGET_FILE:touchstone_${room}>\n")
  endif()
endforeach()
if(TARGET touchstone_conformance)
  string(APPEND artefacts "$<TARGET_FILE:touchstone_conformance>\n$<TARGET_FILE:touchstone_test_result>\n")
endif()
file(GENERATE OUTPUT ${TOUCHSTONE_INSTALLED_FILES} CONTENT "${artefacts}")

# The built program finds the same folders where the installed one does, wherever the build folder is.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/touchstone)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/golden ${PROJECT_BINARY_DIR}/share/touchstone/golden SYMBOLIC)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/synthetic/bundled ${PROJECT_BINARY_DIR}/share/touchstone/datasets SYMBOLIC)

# Found at run time from where the program stands (harness/base/bundled_files.h). What the reports need of scripts and
# styles is inside the program.
install(DIRECTORY synthetic/bundled/ DESTINATION ${TOUCHSTONE_INSTALL_DATADIR}/datasets COMPONENT program)
install(DIRECTORY golden DESTINATION ${TOUCHSTONE_INSTALL_DATADIR} COMPONENT program PATTERN CMakeLists.txt EXCLUDE)
install(FILES ci/dashboard.cmake ci/dashboard_compiler.cmake ci/dashboard_outbox.cmake ci/dashboard_submit.cmake
  DESTINATION ${TOUCHSTONE_INSTALL_DATADIR}/dashboard COMPONENT program)
install(DIRECTORY examples DESTINATION ${TOUCHSTONE_INSTALL_DATADIR})
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)

# The manual of each command.
set(man_pages ${PROJECT_BINARY_DIR}/man)
add_custom_command(OUTPUT ${man_pages}/touchstone.1.gz COMMAND ${PROJECT_SOURCE_DIR}/ci/man-pages ${man_pages}
  DEPENDS ci/man-pages docs/reference/commands.md VERSION VERBATIM)
add_custom_target(touchstone_man_pages DEPENDS ${man_pages}/touchstone.1.gz)
add_dependencies(touchstone_program touchstone_man_pages)
install(DIRECTORY ${man_pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)

# Debian packages from the build tree, by CPack: `cpack --config build/default/CPackConfig.cmake` or ci/package.
#   touchstone        the program, its manual, golden cases and bundled data sets
#   libtouchstone-dev headers, static libraries, package files for find_package, the conformance program, examples
#   touchstone-doc    the guide
#   python3-touchstone  the Python package (TOUCHSTONE_WITH_PYTHON)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME touchstone)
set(CPACK_PACKAGE_VENDOR "Touchstone")
set(CPACK_PACKAGE_CONTACT "The Touchstone maintainers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development documentation)
if(TOUCHSTONE_WITH_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME touchstone)
# Loaded when a command needs them (ARCHITECTURE.md), so that no linker knows of them. Nothing is checked without checksums.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libssl3, libmuparser2v5, libarchive13")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libcurl4, libusb-1.0-0, libcomedi0, gnuplot-nox | gnuplot, git")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtouchstone-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# What find_package(touchstone) looks for: the development packages of ci/packages.txt.
file(STRINGS ${PROJECT_SOURCE_DIR}/ci/packages.txt development_packages REGEX "^lib.*-dev$")
list(REMOVE_ITEM development_packages libumockdev-dev libusb-1.0-0-dev libbenchmark-dev libcpp-httplib-dev)
list(JOIN development_packages ", " development_packages)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "touchstone (= ${PROJECT_VERSION}), cmake (>= 3.25), g++, ${development_packages}")

set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_NAME touchstone-doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SHLIBDEPS OFF)

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-touchstone)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
# The plug-in that runs renderers written in Python links libpython3.11, which dpkg-shlibdeps finds.
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "touchstone (= ${PROJECT_VERSION}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy, libssl3, libarchive13")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib")
# The conformance program, for pytest --touchstone.
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "libtouchstone-dev, python3-pytest, jupyter-notebook")

# The same state gives the same bytes (ci/release): every file bears the time of the commit.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package_times.cmake @ONLY CONTENT [=[
if(DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND find "${CPACK_TEMPORARY_DIRECTORY}" -exec touch -h -d "@$ENV{SOURCE_DATE_EPOCH}" {} + COMMAND_ERROR_IS_FATAL ANY)
endif()
]=])
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_BINARY_DIR}/package_times.cmake)

include(CPack)

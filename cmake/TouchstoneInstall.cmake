# Install and export: find_package(touchstone) works from another folder.
include(CMakePackageConfigHelpers)
install(EXPORT touchstoneTargets NAMESPACE touchstone:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/touchstone)
configure_package_config_file(cmake/touchstoneConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/touchstoneConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/touchstone)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/touchstoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/touchstoneConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/touchstoneConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/touchstone)

# What `cmake --install` puts where: geometry and optimizer with their headers, the package that
# find_package(lightfit) finds, and the command-line program. Included after the targets exist.
#
#   find_package(lightfit REQUIRED)
#   target_link_libraries(engine PRIVATE lightfit::optimizer)    #include <lightfit/optimizer/fit.h>

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(LIGHTFIT_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/lightfit)

install(TARGETS lightfit_base lightfit_geometry lightfit_optimizer EXPORT lightfitTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY base geometry optimizer DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lightfit
  FILES_MATCHING PATTERN "*.h")
if(TARGET lightfit)
  install(TARGETS lightfit RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

install(EXPORT lightfitTargets NAMESPACE lightfit:: DESTINATION ${LIGHTFIT_PACKAGE_DIR})
configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/lightfitConfig.cmake.in ${PROJECT_BINARY_DIR}/lightfitConfig.cmake
  INSTALL_DESTINATION ${LIGHTFIT_PACKAGE_DIR})
# Until 1.0 a minor version may change the interface.
write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/lightfitConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/lightfitConfig.cmake ${PROJECT_BINARY_DIR}/lightfitConfigVersion.cmake
  DESTINATION ${LIGHTFIT_PACKAGE_DIR})

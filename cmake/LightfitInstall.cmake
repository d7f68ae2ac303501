# What `cmake --install` puts where: the core with its headers, the packages that find_package(lightfit)
# and pkg-config find, the schema, the licence, and the program with its manual and
# completion. Included after the targets exist.
#
#   find_package(lightfit REQUIRED)
#   target_link_libraries(engine PRIVATE lightfit::optimizer)    #include "lightfit/optimizer/fit.h"

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(LIGHTFIT_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/lightfit)

install(TARGETS lightfit_base lightfit_geometry lightfit_optimizer lightfit_partition EXPORT lightfitTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
# Headers include each other as "lightfit/geometry/light.h" once they are installed, so that an
# engine's include path gains one name and not `base/`, `geometry/`, `optimizer/` and `partition/`.
install(CODE "
  set(from [[${PROJECT_SOURCE_DIR}]])
  set(to \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/lightfit\")
  include([[${PROJECT_SOURCE_DIR}/cmake/InstallHeaders.cmake]])")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/proto/lightfit
  DESTINATION ${CMAKE_INSTALL_DATADIR}/lightfit/proto FILES_MATCHING PATTERN "*.proto")
if(TARGET lightfit)
  install(TARGETS lightfit RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  # What shells complete by and the manual are what the program itself prints.
  set(share ${PROJECT_BINARY_DIR}/share)
  add_custom_command(OUTPUT ${share}/stamp
    COMMAND ${CMAKE_COMMAND} -E make_directory ${share}/man ${share}/bash ${share}/zsh ${share}/fish
    COMMAND lightfit man --folder ${share}/man
    COMMAND lightfit completion bash > ${share}/bash/lightfit
    COMMAND lightfit completion zsh > ${share}/zsh/_lightfit
    COMMAND lightfit completion fish > ${share}/fish/lightfit.fish
    COMMAND ${CMAKE_COMMAND} -E touch ${share}/stamp
    DEPENDS lightfit VERBATIM)
  add_custom_target(lightfit_share ALL DEPENDS ${share}/stamp)
  install(DIRECTORY ${share}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(DIRECTORY ${share}/bash/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(DIRECTORY ${share}/zsh/ DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  install(DIRECTORY ${share}/fish/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
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

set(LIGHTFIT_PKGCONFIG_CERES "")
if(LIGHTFIT_WITH_CERES)
  set(LIGHTFIT_PKGCONFIG_CERES "-lceres -lglog")   # Ceres has no file of its own
endif()
configure_file(${PROJECT_SOURCE_DIR}/cmake/lightfit.pc.in ${PROJECT_BINARY_DIR}/lightfit.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/lightfit.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# `cmake --install build/release --prefix P` puts the programs into P/bin, and beside them what it takes to build a
# plugin: find_package(loci) gives the target loci::plugin and loci_add_plugin() (docs/annotators.md).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/loci)
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/loci)

add_library(loci_plugin INTERFACE)
set_target_properties(loci_plugin PROPERTIES EXPORT_NAME plugin)
set_target_properties(loci_generate_types PROPERTIES EXPORT_NAME generate_types)
set(targets loci_plugin loci_generate_types)
foreach(library mapping_base mapping_sensor perception_cas perception_types perception_conversions perception_pipeline)
  target_link_libraries(loci_plugin INTERFACE loci_${library})
  set_target_properties(loci_${library} PROPERTIES EXPORT_NAME ${library})
  list(APPEND targets loci_${library})
  string(REPLACE "_" "/" folder ${library})
  cmake_path(GET folder PARENT_PATH wing)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/${folder} DESTINATION ${headers}/${wing}
    FILES_MATCHING PATTERN "*.h" PATTERN generator EXCLUDE)
endforeach()
install(FILES ${CMAKE_BINARY_DIR}/generated/perception/types/generated.h DESTINATION ${headers}/perception/types)
install(FILES ${CMAKE_BINARY_DIR}/generated/perception/pipeline/version.h DESTINATION ${headers}/perception/pipeline)
# Imports by name are looked for here: loci.core is loci/core.xml.
install(DIRECTORY ${CMAKE_SOURCE_DIR}/perception/types/ DESTINATION ${CMAKE_INSTALL_DATADIR}/loci/types/loci
  FILES_MATCHING PATTERN "*.xml" PATTERN generator EXCLUDE)

install(TARGETS ${targets} EXPORT loci
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/loci
  RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/loci
  INCLUDES DESTINATION ${headers})
install(EXPORT loci NAMESPACE loci:: FILE lociTargets.cmake DESTINATION ${package})
configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/lociConfig.cmake.in ${CMAKE_BINARY_DIR}/lociConfig.cmake
  INSTALL_DESTINATION ${package} PATH_VARS CMAKE_INSTALL_DATADIR)
# C++ types cross only within one version.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/lociConfigVersion.cmake COMPATIBILITY ExactVersion)
install(FILES ${CMAKE_BINARY_DIR}/lociConfig.cmake ${CMAKE_BINARY_DIR}/lociConfigVersion.cmake
  ${CMAKE_SOURCE_DIR}/cmake/LociPlugin.cmake DESTINATION ${package})

install(TARGETS loci_rosbag loci_video LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/loci)

# What was not built is not installed.
foreach(program loci loci-map loci-perceive loci-memory loci-simulate loci-evaluate loci-browse)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} OPTIONAL)
  endif()
endforeach()
# Completions and manual pages.
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR})

# `cpack -G DEB` in the build folder makes a Debian package.
set(CPACK_PACKAGE_NAME loci)
set(CPACK_PACKAGE_CONTACT "The loci authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Semantic maps, perception and spatio-temporal object memory for kitchens")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
include(CPack)

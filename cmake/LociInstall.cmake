# `cmake --install build/release --prefix P` puts the programs into P/bin, and beside them the libraries:
# find_package(loci COMPONENTS memory) gives the targets loci::mapping, loci::perception and loci::memory, each with those
# before it, and loci::nbv (docs/cpp.md); without components it gives loci::plugin and loci_add_plugin() (docs/annotators.md).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/loci)
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/loci)

# Public are the headers that programs, examples and the Python module include, and what these include; the rest is
# internal and stays here.
function(loci_public_headers result)
  set(seen perception/types/proxy.h)
  set(queue ${CMAKE_SOURCE_DIR}/perception/types/proxy.h)
  foreach(user apps/map apps/memory apps/perceive apps/simulate docs/examples python)
    file(GLOB_RECURSE files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${user}/*.cpp ${CMAKE_SOURCE_DIR}/${user}/*.h)
    list(APPEND queue ${files})
  endforeach()
  while(queue)
    list(POP_FRONT queue file)
    file(STRINGS ${file} lines REGEX "^#include \"(mapping|nbv|perception|memory)/")
    foreach(line ${lines})
      string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" header ${line})
      if(EXISTS ${CMAKE_SOURCE_DIR}/${header} AND NOT header IN_LIST seen)
        list(APPEND seen ${header})
        list(APPEND queue ${CMAKE_SOURCE_DIR}/${header})
      endif()
    endforeach()
  endwhile()
  set(${result} ${seen} PARENT_SCOPE)
endfunction()

loci_public_headers(public)
foreach(header ${public})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${CMAKE_SOURCE_DIR}/${header} DESTINATION ${headers}/${folder})
endforeach()
install(FILES ${CMAKE_BINARY_DIR}/generated/perception/types/generated.h DESTINATION ${headers}/perception/types)
install(FILES ${CMAKE_BINARY_DIR}/generated/perception/pipeline/version.h DESTINATION ${headers}/perception/pipeline)
# Imports by name are looked for here: loci.core is loci/core.xml.
install(DIRECTORY ${CMAKE_SOURCE_DIR}/perception/types/ DESTINATION ${CMAKE_INSTALL_DATADIR}/loci/types/loci
  FILES_MATCHING PATTERN "*.xml" PATTERN generator EXCLUDE)

# loci::mapping and so on hold all modules of a folder.
add_library(loci_plugin INTERFACE)
set_target_properties(loci_plugin PROPERTIES EXPORT_NAME plugin)
set_target_properties(loci_generate_types PROPERTIES EXPORT_NAME generate_types)
set(targets loci_plugin loci_generate_types)
foreach(folder mapping perception memory)
  add_library(loci_${folder}_all INTERFACE)
  set_target_properties(loci_${folder}_all PROPERTIES EXPORT_NAME ${folder})
  list(APPEND targets loci_${folder}_all)
endforeach()
target_link_libraries(loci_perception_all INTERFACE loci_mapping_all)
target_link_libraries(loci_memory_all INTERFACE loci_perception_all)
foreach(library ${LOCI_MODULES})
  string(REGEX REPLACE "_.*" "" folder ${library})
  if(TARGET loci_${folder}_all)
    target_link_libraries(loci_${folder}_all INTERFACE loci_${library})
  endif()
  set_target_properties(loci_${library} PROPERTIES EXPORT_NAME ${library})
  list(APPEND targets loci_${library})
endforeach()
foreach(library mapping_base mapping_sensor perception_cas perception_types perception_conversions perception_pipeline)
  target_link_libraries(loci_plugin INTERFACE loci_${library})
endforeach()
target_compile_features(loci_mapping_base INTERFACE cxx_std_20)
# Readers of videos and of some depth images are loaded when they are needed.
target_link_options(loci_mapping_recording INTERFACE
  "$<INSTALL_INTERFACE:LINKER:-rpath,$<INSTALL_PREFIX>/${CMAKE_INSTALL_LIBDIR}/loci>")

install(TARGETS ${targets} EXPORT loci
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/loci
  RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/loci
  INCLUDES DESTINATION ${headers})
install(EXPORT loci NAMESPACE loci:: FILE lociTargets.cmake DESTINATION ${package})
configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/lociConfig.cmake.in ${CMAKE_BINARY_DIR}/lociConfig.cmake
  INSTALL_DESTINATION ${package} PATH_VARS CMAKE_INSTALL_DATADIR)
# The public headers keep within a minor version. (A plugin is checked for the exact version when it is loaded.)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/lociConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/lociConfig.cmake ${CMAKE_BINARY_DIR}/lociConfigVersion.cmake
  ${CMAKE_SOURCE_DIR}/cmake/LociPlugin.cmake DESTINATION ${package})

install(TARGETS loci_video loci_depth loci_postgres loci_people LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/loci)
if(TARGET loci_open3d)
  install(TARGETS loci_open3d LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/loci)
endif()

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

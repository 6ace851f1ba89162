# loci_add_plugin(NAME SOURCES a.cpp ... [TYPES b.xml ... NAMESPACE ns])
#
# A plugin for loci-perceive --plugin. From TYPES, type systems in UIMA's XML, typed proxies are generated:
# #include "NAME/generated.h" declares them in the namespace ns, with ns::type_sources() for LOCI_PLUGIN.
function(loci_add_plugin name)
  cmake_parse_arguments(ARG "" "NAMESPACE" "SOURCES;TYPES" ${ARGN})
  if(ARG_TYPES)
    if(NOT ARG_NAMESPACE)
      message(FATAL_ERROR "loci_add_plugin(${name}): TYPES need a NAMESPACE")
    endif()
    set(output ${CMAKE_CURRENT_BINARY_DIR}/generated)
    list(TRANSFORM ARG_TYPES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
    add_custom_command(
      OUTPUT ${output}/${name}/generated.h ${output}/${name}/generated.cpp
      COMMAND loci::generate_types proxies ${ARG_NAMESPACE} ${name} ${output} --path ${LOCI_TYPES_PATH} ${ARG_TYPES}
      DEPENDS ${ARG_TYPES} $<TARGET_FILE:loci::generate_types>
      COMMENT "Generating the proxies of ${name}")
    list(APPEND ARG_SOURCES ${output}/${name}/generated.h ${output}/${name}/generated.cpp)
  endif()
  add_library(${name} MODULE ${ARG_SOURCES})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE loci::plugin)
  target_include_directories(${name} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated)
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_EXTENSIONS OFF)
endfunction()

# One verb per kind of target:
#   loci_add_module(FOLDER)                   add a module: a folder with a CMakeLists.txt of its own
#   loci_library(LINKS ... PRIVATE_LINKS ...) all *.cpp of this folder as one static library, named after the folder
#                                             (but those under EXCLUDE folders; with GENERATED sources)
#   loci_generate_types(FOLDER NAMESPACE XML ...)  typed proxies from type systems: FOLDER/generated.{h,cpp} in the build folder
#   loci_generate_messages(SOURCES FILE.proto)  C++ of protobuf messages, included as FOLDER/FILE.pb.h; SOURCES is set to
#                                             what goes into GENERATED, and LINKS needs protobuf::libprotobuf
#   loci_program(NAME [NO_UNITY] [SOURCES ...] LINKS ...) a program in bin/
#   loci_test([NO_UNITY] LINKS ...)           all *_test.cpp of this folder as one GoogleTest program
#
# The library of mapping/base is the target loci_mapping_base, and so on.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
# Modules that programs load when they need them.
include(GNUInstallDirs)
set(CMAKE_BUILD_RPATH ${CMAKE_BINARY_DIR}/lib/loci)
set(CMAKE_INSTALL_RPATH $ORIGIN/../${CMAKE_INSTALL_LIBDIR}/loci)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# Same bytes on every build: floating-point expressions are not contracted.
add_compile_options(-ffp-contract=off)

# Only libraries that a program uses are loaded at its start.
add_link_options(-Wl,--as-needed)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # Without these, ccache passes over everything that uses a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
endif()

if(LOCI_SANITIZE)
  # With a sanitizer Eigen would pad blocks that PCL's libraries, which were built without one, hand to free().
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
  add_compile_options(-fsanitize=${LOCI_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # The sanitizers' dlopen is not the program's: it finds modules by RPATH, not by RUNPATH.
  add_link_options(-fsanitize=${LOCI_SANITIZE} -Wl,--disable-new-dtags)
endif()

function(loci_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion)
  # GCC 12 reports overlaps inside std::string that cannot happen (PR 105651).
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
  if(LOCI_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

function(loci_add_module folder)
  if(NOT EXISTS ${CMAKE_SOURCE_DIR}/${folder}/CMakeLists.txt)
    message(FATAL_ERROR "loci_add_module: ${folder}/CMakeLists.txt does not exist")
  endif()
  add_subdirectory(${CMAKE_SOURCE_DIR}/${folder})
  string(REPLACE "/" "_" name ${folder})
  if(TARGET loci_${name})
    set(LOCI_MODULES ${LOCI_MODULES} ${name} PARENT_SCOPE)
  endif()
endfunction()

# Most of a compilation is parsing Eigen, OpenCV and the standard library. A unity build parses them once for several
# sources; the sources still compile one by one with -DLOCI_UNITY=OFF. NO_UNITY is for targets whose sources have
# internal names in common.
function(loci_unity target)
  if(LOCI_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 10)
    # Of anonymous namespaces in an included source.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# What most sources of libraries include is parsed once, in loci_headers. A build without unities, which shows that
# every source includes what it needs, goes without.
function(loci_precompile target)
  if(NOT LOCI_UNITY)
    return()
  endif()
  if(NOT TARGET loci_headers)
    file(WRITE ${CMAKE_BINARY_DIR}/loci_headers.cpp "")
    add_library(loci_headers STATIC EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/loci_headers.cpp)
    target_link_libraries(loci_headers PRIVATE Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json)
    target_precompile_headers(loci_headers PRIVATE <Eigen/Geometry> <fmt/format.h> <nlohmann/json.hpp> <algorithm>
      <chrono> <filesystem> <fstream> <functional> <map> <memory> <numeric> <optional> <random> <set> <span> <sstream>
      <string> <unordered_map> <variant> <vector>)
    loci_precompiled(loci_headers)
    loci_warnings(loci_headers)
  endif()
  loci_precompiled(${target})
  target_precompile_headers(${target} REUSE_FROM loci_headers)
endfunction()

# ccache needs to know that a precompiled header is used.
function(loci_precompiled target)
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()

function(loci_folder_name result)
  file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REPLACE "/" "_" name ${folder})
  set(${result} ${name} PARENT_SCOPE)
endfunction()

function(loci_library)
  cmake_parse_arguments(ARG "NO_UNITY" "" "LINKS;PRIVATE_LINKS;EXCLUDE;GENERATED" ${ARGN})
  loci_folder_name(name)
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  file(GLOB_RECURSE nested CONFIGURE_DEPENDS */*.cpp)
  foreach(excluded ${ARG_EXCLUDE})
    list(FILTER nested EXCLUDE REGEX "/${excluded}/")
  endforeach()
  add_library(loci_${name} STATIC ${sources} ${nested} ${ARG_GENERATED})
  target_include_directories(loci_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>)
  target_link_libraries(loci_${name} PUBLIC ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
  if(NOT ARG_NO_UNITY)
    loci_unity(loci_${name})
  endif()
  loci_precompile(loci_${name})
  loci_warnings(loci_${name})
endfunction()

function(loci_generate_types folder namespace)
  set(output ${CMAKE_BINARY_DIR}/generated/${folder})
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE files)
  add_custom_command(
    OUTPUT ${output}/generated.h ${output}/generated.cpp
    COMMAND loci_generate_types proxies ${namespace} ${folder} ${CMAKE_BINARY_DIR}/generated ${files}
    DEPENDS loci_generate_types ${files}
    COMMENT "Generating the proxies of ${folder}")
endfunction()

function(loci_generate_messages sources file)
  set(generated ${CMAKE_BINARY_DIR}/generated)
  file(RELATIVE_PATH source ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  string(REGEX REPLACE "\\.proto$" ".pb" messages ${generated}/${source})
  add_custom_command(
    OUTPUT ${messages}.h ${messages}.cc
    COMMAND ${CMAKE_COMMAND} -E make_directory ${generated}
    COMMAND protobuf::protoc --proto_path=${CMAKE_SOURCE_DIR} --cpp_out=${generated} ${source}
    DEPENDS ${file}
    WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
    COMMENT "Generating the messages of ${source}")
  # The code is protoc's; so are its warnings.
  set_source_files_properties(${messages}.cc PROPERTIES COMPILE_OPTIONS "-w")
  set(${sources} ${messages}.h ${messages}.cc PARENT_SCOPE)
endfunction()

function(loci_program name)
  cmake_parse_arguments(ARG "NO_UNITY" "" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_SOURCES)
    file(GLOB ARG_SOURCES CONFIGURE_DEPENDS *.cpp)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS})
  if(NOT ARG_NO_UNITY)
    loci_unity(${name})
  endif()
  loci_warnings(${name})
endfunction()

# Tests wait for what they test: optimising their own code beyond this takes longer than it saves. (Not at all would be
# worse: the linker may take Eigen's functions from here for the libraries, too.)
function(loci_test_options target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  loci_warnings(${target})
endfunction()

# What every test includes is parsed once, in loci_test_headers.
function(loci_test_precompile target)
  if(NOT TARGET loci_test_headers)
    # An executable, as the tests are: the header is valid for targets that compile with the same flags.
    file(WRITE ${CMAKE_BINARY_DIR}/loci_test_headers.cpp "int main() {}\n")
    add_executable(loci_test_headers EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/loci_test_headers.cpp)
    set_target_properties(loci_test_headers PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
    target_link_libraries(loci_test_headers PRIVATE loci_mapping_base GTest::gmock)
    target_precompile_headers(loci_test_headers PRIVATE <gmock/gmock.h> <gtest/gtest.h> <Eigen/Geometry>
      <fmt/format.h> <nlohmann/json.hpp> <filesystem> <map> <optional> <random> <sstream> <string> <vector>)
    loci_precompiled(loci_test_headers)
    loci_test_options(loci_test_headers)
  endif()
  loci_precompiled(${target})
  target_precompile_headers(${target} REUSE_FROM loci_test_headers)
endfunction()

function(loci_test)
  cmake_parse_arguments(ARG "NO_UNITY" "" "LINKS" ${ARGN})
  loci_folder_name(name)
  file(GLOB sources CONFIGURE_DEPENDS *_test.cpp)
  add_executable(${name} ${sources})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} loci_mapping_base GTest::gmock GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR})
  loci_test_precompile(${name})
  target_compile_definitions(${name} PRIVATE
    LOCI_SOURCE_DIR="${CMAKE_SOURCE_DIR}"
    LOCI_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}"
    LOCI_SHARED_DIR="${LOCI_SHARED_DIR}")
  if(NOT ARG_NO_UNITY)
    loci_unity(${name})
  endif()
  loci_test_options(${name})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST TEST_PREFIX "${name}." PROPERTIES TIMEOUT 900)
endfunction()

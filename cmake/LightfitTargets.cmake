# Compiler settings, and the three functions that every folder's CMakeLists.txt uses.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
# Sanitizer builds: Eigen at -O1 is half as fast, and clang compiles -O2 no slower.
set(CMAKE_CXX_FLAGS_DEBUG "-O2 -g1")

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_CURRENT_LIST_DIR}/ccache.sh)
endif()
find_program(MOLD_PROGRAM mold)
if(MOLD_PROGRAM)
  add_link_options(-fuse-ld=mold)
endif()

# g++ has the memory (scripts/common.sh gives each 2 GB): collecting garbage took an eighth of its time.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options("SHELL:--param ggc-min-expand=1000" "SHELL:--param ggc-min-heapsize=1000000")
endif()

# Private to this build. Consumers of the installed package are not told how to compile.
add_library(lightfit_settings INTERFACE)
target_compile_options(lightfit_settings INTERFACE
  -Wall -Wextra -Wpedantic -Werror=return-type
  -ffp-contract=off)   # so that results repeat from build to build; never -ffast-math, -march=native
if(LIGHTFIT_SANITIZE)
  # To ask at every access of a matrix for null, alignment and size made the tests three times as
  # slow. The address sanitizer stops at null too, and Eigen asserts what alignment it needs.
  add_compile_options(-fsanitize=${LIGHTFIT_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=undefined -fno-sanitize=null,alignment,object-size)
  add_link_options(-fsanitize=${LIGHTFIT_SANITIZE})
  if(LIGHTFIT_SANITIZE MATCHES "address")
    # Ceres is not instrumented: our allocations must not carry Eigen's own alignment header.
    add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
endif()

# What nearly every source includes, read once and not by each of them. Off where a missing #include
# is to be found (preset core).
option(LIGHTFIT_WITH_PCH "Precompile the headers of Eigen, Abseil and GoogleTest" ON)
set(LIGHTFIT_PCH_HEADERS
  <Eigen/Dense> <absl/status/statusor.h> <absl/strings/str_cat.h> <absl/strings/str_format.h>
  <absl/types/span.h> <algorithm> <cmath> <functional> <string> <vector>)
if(LIGHTFIT_WITH_PCH)
  # What ccache wants to see the same file in two runs.
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
    add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
  else()
    add_compile_options(-fpch-preprocess)
  endif()
endif()

# lightfit_library(NAME SOURCES ... [DEPS public...] [PRIVATE_DEPS ...] [PCH header ...]): alias
# lightfit::NAME. PCH: headers worth precompiling for this library alone.
function(lightfit_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;PRIVATE_DEPS;PCH" ${ARGN})
  add_library(lightfit_${name} STATIC ${ARG_SOURCES})
  add_library(lightfit::${name} ALIAS lightfit_${name})
  set_target_properties(lightfit_${name} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(lightfit_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:include>)
  target_compile_features(lightfit_${name} PUBLIC cxx_std_20)
  target_link_libraries(lightfit_${name}
    PUBLIC ${ARG_DEPS} PRIVATE $<BUILD_INTERFACE:lightfit_settings> ${ARG_PRIVATE_DEPS})
  if(LIGHTFIT_WITH_PCH AND ARG_PCH)
    target_precompile_headers(lightfit_${name} PRIVATE ${LIGHTFIT_PCH_HEADERS} ${ARG_PCH})
  elseif(LIGHTFIT_WITH_PCH)
    if(NOT TARGET lightfit_pch)
      add_library(lightfit_pch OBJECT ${PROJECT_SOURCE_DIR}/cmake/empty.cc)
      set_target_properties(lightfit_pch PROPERTIES POSITION_INDEPENDENT_CODE ON)
      target_compile_features(lightfit_pch PRIVATE cxx_std_20)
      target_link_libraries(lightfit_pch PRIVATE
        lightfit_settings Eigen3::Eigen absl::statusor absl::str_format absl::span)
      target_precompile_headers(lightfit_pch PRIVATE ${LIGHTFIT_PCH_HEADERS})
    endif()
    target_precompile_headers(lightfit_${name} REUSE_FROM lightfit_pch)
  endif()
endfunction()

# lightfit_tests(FOLDER [NAME program] [SHARDS n] [FILES name_test.cc ...] [EXCEPT name_test.cc ...]
#   [SOURCES more.cc ...] [PROGRAMS target ...] [OWN_FLAGS] DEPS ...): one program of all *_test.cc in
# tests/FOLDER, or of FILES alone or all EXCEPT some, and its entry in CTest: FOLDER, or FOLDER/i of
# n shards, which run side by side. The label is the folder. PROGRAMS are run by the tests.
# OWN_FLAGS: DEPS come with compiler flags that the precompiled headers do not have.
#
# One program for a folder links and starts in a fraction of the time of one for each file. A single
# test: build/release/tests/NAME --gtest_filter='Suite.*'.
function(lightfit_tests folder)
  cmake_parse_arguments(ARG "OWN_FLAGS" "NAME;SHARDS" "FILES;EXCEPT;SOURCES;PROGRAMS;DEPS" ${ARGN})
  if(NOT ARG_NAME)
    set(ARG_NAME ${folder})
  endif()
  if(NOT ARG_SHARDS)
    set(ARG_SHARDS 1)
  endif()
  set(here ${PROJECT_SOURCE_DIR}/tests/${folder})
  if(ARG_FILES)
    list(TRANSFORM ARG_FILES PREPEND ${here}/)
  else()
    file(GLOB ARG_FILES CONFIGURE_DEPENDS ${here}/*_test.cc)
    list(TRANSFORM ARG_EXCEPT PREPEND ${here}/)
    list(REMOVE_ITEM ARG_FILES "" ${ARG_EXCEPT})
  endif()
  list(TRANSFORM ARG_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/tests/)
  string(REPLACE "/" "_" program ${ARG_NAME})
  set(target test_${program})
  add_executable(${target} ${ARG_FILES} ${ARG_SOURCES})
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME ${program} RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests/bin)
  target_link_libraries(${target} PRIVATE
    ${ARG_DEPS} lightfit::testing lightfit_settings GTest::gmock GTest::gtest_main)
  if(ARG_PROGRAMS)
    add_dependencies(${target} ${ARG_PROGRAMS})
  endif()
  # What is tested is optimised; the tests themselves need not be, and compile in half the time.
  target_compile_options(${target} PRIVATE -O1)
  if(LIGHTFIT_WITH_PCH AND NOT ARG_OWN_FLAGS)
    if(NOT TARGET test_pch)
      add_library(test_pch OBJECT ${PROJECT_SOURCE_DIR}/cmake/empty.cc)
      target_link_libraries(test_pch PRIVATE lightfit::testing lightfit_settings GTest::gmock)
      target_compile_options(test_pch PRIVATE -O1)
      target_precompile_headers(test_pch PRIVATE
        <gmock/gmock.h> <gtest/gtest.h> ${LIGHTFIT_PCH_HEADERS})
    endif()
    target_precompile_headers(${target} REUSE_FROM test_pch)
  endif()
  math(EXPR last "${ARG_SHARDS} - 1")
  foreach(shard RANGE ${last})
    set(entry ${ARG_NAME})
    if(last GREATER 0)
      math(EXPR number "${shard} + 1")
      set(entry ${ARG_NAME}/${number})
    endif()
    string(REPLACE "/" "_" report ${entry})
    add_test(NAME ${entry} COMMAND ${target})
    set_tests_properties(${entry} PROPERTIES LABELS ${folder} TIMEOUT 900 ENVIRONMENT
      "GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${shard};GTEST_OUTPUT=xml:${PROJECT_BINARY_DIR}/gtest/${report}.xml")
  endforeach()
endfunction()

# lightfit_benchmark(NAME DEPS ...): a program bin/bench_NAME.
function(lightfit_benchmark name)
  cmake_parse_arguments(ARG "" "" "DEPS" ${ARGN})
  add_executable(bench_${name} ${name}.cc)
  target_link_libraries(bench_${name} PRIVATE ${ARG_DEPS} lightfit_settings benchmark::benchmark)
endfunction()

# Compiler settings, and the three functions that every folder's CMakeLists.txt uses.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
# Sanitizer builds keep -O1 -g1: at -O2 -g the CGAL and Ceres sources take a minute and 1.5 GB each.
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g1")

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()
find_program(MOLD_PROGRAM mold)
if(MOLD_PROGRAM)
  add_link_options(-fuse-ld=mold)
endif()

# Private to this build. Consumers of the installed package are not told how to compile.
add_library(lightfit_settings INTERFACE)
target_compile_options(lightfit_settings INTERFACE
  -Wall -Wextra -Wpedantic -Werror=return-type
  -ffp-contract=off)   # so that results repeat from build to build; never -ffast-math, -march=native
if(LIGHTFIT_SANITIZE)
  add_compile_options(-fsanitize=${LIGHTFIT_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=${LIGHTFIT_SANITIZE})
  if(LIGHTFIT_SANITIZE MATCHES "address")
    # Ceres is not instrumented: our allocations must not carry Eigen's own alignment header.
    add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
endif()

# lightfit_library(NAME SOURCES ... [DEPS public...] [PRIVATE_DEPS ...]): alias lightfit::NAME.
function(lightfit_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(lightfit_${name} STATIC ${ARG_SOURCES})
  add_library(lightfit::${name} ALIAS lightfit_${name})
  set_target_properties(lightfit_${name} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(lightfit_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:include>
    $<INSTALL_INTERFACE:include/lightfit>)
  target_compile_features(lightfit_${name} PUBLIC cxx_std_20)
  target_link_libraries(lightfit_${name}
    PUBLIC ${ARG_DEPS} PRIVATE $<BUILD_INTERFACE:lightfit_settings> ${ARG_PRIVATE_DEPS})
endfunction()

# lightfit_test(folder/name_test DEPS ...), paths relative to tests/: CTest names are
# folder/Suite.Test, with the folder as label.
function(lightfit_test path)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  string(REPLACE "/" "_" target ${path})
  get_filename_component(folder ${path} DIRECTORY)
  list(TRANSFORM ARG_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/tests/)
  add_executable(${target} ${PROJECT_SOURCE_DIR}/tests/${path}.cc ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE
    ${ARG_DEPS} lightfit_settings GTest::gmock GTest::gtest_main rapidcheck rapidcheck_gtest)
  gtest_discover_tests(${target}
    TEST_PREFIX ${folder}/ DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${folder} TIMEOUT 600)
endfunction()

# lightfit_benchmark(NAME DEPS ...): a program bin/bench_NAME.
function(lightfit_benchmark name)
  cmake_parse_arguments(ARG "" "" "DEPS" ${ARGN})
  add_executable(bench_${name} ${name}.cc)
  target_link_libraries(bench_${name} PRIVATE ${ARG_DEPS} lightfit_settings benchmark::benchmark)
endfunction()

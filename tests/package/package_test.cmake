# Installs the build into an empty prefix, then configures, builds and runs the consumer against it.
# In:   LIGHTFIT_BINARY_DIR, LIGHTFIT_WITH_CERES, CONSUMER_SOURCE_DIR, WORK_DIR, GENERATOR,
#       CXX_COMPILER[_LAUNCHER].
# Out:  success, or the first step that failed with its output.

function(run_step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  endif()
  message(STATUS "${what}: ok")
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run_step("install" ${CMAKE_COMMAND} --install ${LIGHTFIT_BINARY_DIR} --prefix ${WORK_DIR}/prefix)

# The package must be enough as it stands: nothing from this repository, and no CGAL.
run_step("configure" ${CMAKE_COMMAND} -S ${CONSUMER_SOURCE_DIR} -B ${WORK_DIR}/build -G "${GENERATOR}"
  -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix
  -DCMAKE_DISABLE_FIND_PACKAGE_CGAL=TRUE
  -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
  -DCMAKE_CXX_COMPILER_LAUNCHER=${CXX_COMPILER_LAUNCHER})
run_step("build" ${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run_step("run" ${WORK_DIR}/build/consumer)

# Once more for those who do not use CMake.
execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${WORK_DIR}/prefix/lib/pkgconfig
  pkg-config --define-prefix --cflags --libs lightfit
  RESULT_VARIABLE result OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "pkg-config knows no lightfit")
endif()
separate_arguments(flags)
run_step("build with pkg-config" ${CXX_COMPILER} -std=c++20 ${CONSUMER_SOURCE_DIR}/consumer.cc
  -o ${WORK_DIR}/with_pkg_config ${flags})
run_step("run" ${WORK_DIR}/with_pkg_config)

# One name on an engine's include path, the licence and the schema beside it.
file(GLOB names RELATIVE ${WORK_DIR}/prefix/include ${WORK_DIR}/prefix/include/*)
if(NOT names STREQUAL "lightfit")
  message(FATAL_ERROR "include/ has ${names}, want lightfit alone")
endif()
foreach(file share/doc/lightfit/LICENSE)
  if(NOT EXISTS ${WORK_DIR}/prefix/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()

# With the program comes what shells complete by and the manual: what it prints itself.
set(program ${WORK_DIR}/prefix/bin/lightfit)
if(EXISTS ${program})
  foreach(pair "share/bash-completion/completions/lightfit=completion bash"
      "share/zsh/site-functions/_lightfit=completion zsh"
      "share/fish/vendor_completions.d/lightfit.fish=completion fish"
      "share/man/man1/lightfit.1=man" "share/man/man1/lightfit-fit.1=man fit")
    string(REGEX MATCH "(.*)=(.*)" pair ${pair})
    set(file ${WORK_DIR}/prefix/${CMAKE_MATCH_1})
    separate_arguments(words UNIX_COMMAND ${CMAKE_MATCH_2})
    execute_process(COMMAND ${program} ${words} OUTPUT_VARIABLE printed)
    if(NOT EXISTS ${file})
      message(FATAL_ERROR "${file} is not installed")
    endif()
    file(READ ${file} installed)
    if(NOT installed STREQUAL printed)
      message(FATAL_ERROR "${file} is not what lightfit ${words} prints")
    endif()
  endforeach()
  message(STATUS "completion and manual: ok")
endif()

# Without Ceres an engine loads none of what comes with it.
if(NOT LIGHTFIT_WITH_CERES)
  execute_process(COMMAND ldd ${WORK_DIR}/build/consumer OUTPUT_VARIABLE libraries)
  if(libraries MATCHES "ceres|cholmod|suitesparse|spqr|blas|lapack|atlas|gfortran|glog|gflags")
    message(FATAL_ERROR "the consumer loads ${CMAKE_MATCH_0}:\n${libraries}")
  endif()
  message(STATUS "no Ceres, SuiteSparse, BLAS, gfortran or glog: ok")
endif()

# Installs the build into an empty prefix, then configures, builds and runs the consumer against it.
# In:   LIGHTFIT_BINARY_DIR, CONSUMER_SOURCE_DIR, WORK_DIR, GENERATOR, CXX_COMPILER[_LAUNCHER].
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

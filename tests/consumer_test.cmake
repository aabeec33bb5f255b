# SPDX-License-Identifier: Apache-2.0
# Installs the library and builds and runs tests/consumer against it: find_package(relumine) must be all that a user needs.
#   cmake -D BUILD_DIR=… -D SOURCE_DIR=… -D CXX_COMPILER=… -D CONFIG=… -P consumer_test.cmake
set(scratch ${BUILD_DIR}/consumer_test)
file(REMOVE_RECURSE ${scratch})

function(run)
    execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --config ${CONFIG} --prefix ${scratch}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/tests/consumer -B ${scratch}/build -G Ninja
    -D CMAKE_PREFIX_PATH=${scratch}/prefix -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D CMAKE_BUILD_TYPE=${CONFIG}
    -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
run(${CMAKE_COMMAND} --build ${scratch}/build)
run(${scratch}/build/consumer)
run(${scratch}/prefix/bin/relumine --version)
file(REMOVE_RECURSE ${scratch})

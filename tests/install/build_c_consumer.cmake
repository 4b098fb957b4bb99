# Builds and runs the C consumer in SOURCE by find_package(earshot), then by what pkg-config says; see
# CMakeLists.txt for the arguments.
cmake_minimum_required(VERSION 3.25)
execute_process(
  COMMAND ${CTEST} --build-and-test ${SOURCE} ${BINARY} --build-generator ${GENERATOR}
    --build-options -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_C_COMPILER=${COMPILER}
    --test-command ${CTEST} --output-on-failure --no-tests=error
  COMMAND_ERROR_IS_FATAL ANY)

find_program(pkg_config pkg-config REQUIRED)
set(ENV{PKG_CONFIG_PATH} ${PKG_CONFIG_DIR}:$ENV{PKG_CONFIG_PATH})
execute_process(COMMAND ${pkg_config} --cflags --libs earshot-c
  OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${flags}")
execute_process(COMMAND ${COMPILER} -std=c99 -pedantic -Wall -Werror ${SOURCE}/shoebox.c ${flags}
  -o ${BINARY}/by_pkg_config COMMAND_ERROR_IS_FATAL ANY)
set(ENV{LD_LIBRARY_PATH} ${LIBRARY_DIR}:$ENV{LD_LIBRARY_PATH})
execute_process(COMMAND ${BINARY}/by_pkg_config COMMAND_ERROR_IS_FATAL ANY)

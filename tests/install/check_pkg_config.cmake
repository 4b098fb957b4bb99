# Compiles and runs the consumer's program by what pkg-config says, and compares its digests with the
# library's own; see CMakeLists.txt for the arguments. Fast mathematics must be refused.
cmake_minimum_required(VERSION 3.25)
find_program(pkg_config pkg-config REQUIRED)
set(ENV{PKG_CONFIG_PATH} ${PKG_CONFIG_DIR}:$ENV{PKG_CONFIG_PATH})
file(MAKE_DIRECTORY ${SCRATCH})
foreach(kind cflags libs)
  execute_process(COMMAND ${pkg_config} --${kind} earshot
    OUTPUT_VARIABLE ${kind} OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(${kind} UNIX_COMMAND "${${kind}}")
endforeach()
separate_arguments(flags UNIX_COMMAND "${FLAGS}")

execute_process(COMMAND ${COMPILER} ${flags} -O1 ${cflags} ${SOURCE}/digest.cpp ${libs}
  -o ${SCRATCH}/digest COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${SCRATCH}/digest OUTPUT_VARIABLE digests COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${LIBRARY_DIGEST} OUTPUT_VARIABLE expected COMMAND_ERROR_IS_FATAL ANY)
if(NOT digests STREQUAL expected)
  message(FATAL_ERROR "digests:\n${digests}the library's own:\n${expected}")
endif()

execute_process(COMMAND ${COMPILER} ${cflags} -ffast-math -fsyntax-only ${SOURCE}/component.cpp
  RESULT_VARIABLE status ERROR_VARIABLE error)
if(status EQUAL 0 OR NOT error MATCHES "earshot needs IEEE 754 arithmetic")
  message(FATAL_ERROR "-ffast-math is not refused: ${error}")
endif()

# Configures, builds and tests the consumer in SOURCE; see CMakeLists.txt for the arguments.
cmake_minimum_required(VERSION 3.25)
if(FLAGS MATCHES "x86-64-v3" AND EXISTS /proc/cpuinfo)
  file(STRINGS /proc/cpuinfo capabilities REGEX "^flags" LIMIT_COUNT 1)
  foreach(capability avx2 fma bmi1 bmi2 f16c movbe)
    if(NOT capabilities MATCHES " ${capability}( |$)")
      message(STATUS "skipped: this CPU has no ${capability}, which x86-64-v3 asks for")
      return()
    endif()
  endforeach()
endif()
execute_process(
  COMMAND ${CTEST} --build-and-test ${SOURCE} ${BINARY} --build-generator ${GENERATOR}
    --build-options -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
      -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
      -DLIBRARY_DIGEST=${LIBRARY_DIGEST}
    --test-command ${CTEST} --output-on-failure --no-tests=error
  RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the consumer failed with the flags '${FLAGS}'")
endif()

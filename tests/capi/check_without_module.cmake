# Fails if the library needs HDF5 to be loaded, or if the tests of the group `without_module` fail with a copy
# of it that has no module beside it. Arguments: LIBRARY, SONAME, PROGRAM, READELF, SOURCE_DIR, SCRATCH.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${READELF} -d ${LIBRARY} OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "NEEDED[^\n]*" needed "${table}")
list(FILTER needed INCLUDE REGEX "hdf5|curl")
if(needed)
  message(FATAL_ERROR "the library is linked with what only its module needs: ${needed}")
endif()
file(MAKE_DIRECTORY ${SCRATCH})
configure_file(${LIBRARY} ${SCRATCH}/${SONAME} COPYONLY)
set(ENV{LD_LIBRARY_PATH} ${SCRATCH})
execute_process(COMMAND ${PROGRAM} without_module ${SOURCE_DIR} WORKING_DIRECTORY ${SCRATCH}
  COMMAND_ERROR_IS_FATAL ANY)

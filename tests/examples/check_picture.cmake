# Fails if PROGRAM, run on SCENE with ORDER, does not draw PICTURE.
execute_process(COMMAND ${PROGRAM} ${SCENE} ${ORDER} OUTPUT_VARIABLE drawn RESULT_VARIABLE status)
file(READ ${PICTURE} picture)
if(NOT status EQUAL 0 OR NOT drawn STREQUAL picture)
  message(FATAL_ERROR "${PROGRAM} does not draw ${PICTURE} (exit status ${status})")
endif()

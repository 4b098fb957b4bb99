# Fails unless the programs ONE and OTHER print the same.
execute_process(COMMAND ${ONE} OUTPUT_VARIABLE one COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${OTHER} OUTPUT_VARIABLE other COMMAND_ERROR_IS_FATAL ANY)
if(NOT one STREQUAL other)
  message(FATAL_ERROR "${ONE} prints\n${one}${OTHER} prints\n${other}")
endif()
message(STATUS "both print\n${one}")

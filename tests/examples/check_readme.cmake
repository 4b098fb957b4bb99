# Fails if README does not hold EXAMPLE, its first line (the licence) aside.
file(READ ${EXAMPLE} example)
file(READ ${README} readme)
string(REGEX REPLACE "^[^\n]*\n" "" example "${example}")
string(FIND "${readme}" "${example}" position)
if(position EQUAL -1)
  message(FATAL_ERROR "${README} does not show ${EXAMPLE} as it is")
endif()

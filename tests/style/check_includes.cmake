# Reads every include of the library folders and fails if
#   a folder includes another against the order that MAY_INCLUDE_X says,
#   a folder includes what is internal to another,
#   headers include each other in a circle,
#   a source x.cpp beside or above its header x.h does not include that first (the build then proves
#     that the header compiles alone),
#   another header does not compile alone,
#   a public header does not reach base/floating_point.h, which refuses compilers' fast mathematics.
# Arguments: SOURCE_DIR, FOLDERS (joined by commas), MAY_INCLUDE_X for each folder (likewise),
# COMPILER, INCLUDES (directories, joined by commas), SCRATCH.
cmake_minimum_required(VERSION 3.25)
string(REPLACE "," ";" folders "${FOLDERS}")
string(REPLACE "," ";" include_flags "${INCLUDES}")
list(TRANSFORM include_flags PREPEND "-I")
set(guard base/floating_point.h)
set(complaints)

set(headers)
set(proven)  # headers that are the first include of their own source
foreach(folder IN LISTS folders)
  string(REPLACE "," ";" allowed "${MAY_INCLUDE_${folder}}")
  file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR}
    ${SOURCE_DIR}/${folder}/*.h ${SOURCE_DIR}/${folder}/*.cpp)
  foreach(file IN LISTS files)
    file(STRINGS ${SOURCE_DIR}/${file} lines REGEX "^#include \"earshot/")
    set(includes)
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^#include \"earshot/([^\"]+)\".*$" "\\1" include "${line}")
      list(APPEND includes ${include})
      string(REGEX REPLACE "/.*$" "" other "${include}")
      if(NOT other STREQUAL folder)
        if(NOT other IN_LIST allowed)
          string(APPEND complaints "  ${file} includes ${include} against the order\n")
        elseif(include MATCHES "/(internal|kernels)/")
          string(APPEND complaints "  ${file} includes ${include}, which is internal\n")
        endif()
      endif()
    endforeach()
    if(file MATCHES "[.]h$")
      list(APPEND headers ${file})
      set(includes_of_${file} "${includes}")
    elseif(includes)
      list(GET includes 0 first)
      cmake_path(GET file STEM stem)
      if(first MATCHES "(^|/)${stem}[.]h$")
        list(APPEND proven ${first})
      endif()
    endif()
  endforeach()
endforeach()

# Headers leave in the order of their includes; those that never can are a circle.
set(pending ${headers})
set(guarded)
set(has_changed TRUE)
while(pending AND has_changed)
  set(has_changed FALSE)
  foreach(header IN LISTS pending)
    set(waits FALSE)
    set(is_guarded FALSE)
    foreach(include IN LISTS includes_of_${header})
      if(include IN_LIST pending)
        set(waits TRUE)
        break()
      endif()
      if(include STREQUAL guard OR include IN_LIST guarded)
        set(is_guarded TRUE)
      endif()
    endforeach()
    if(NOT waits)
      list(REMOVE_ITEM pending ${header})
      set(has_changed TRUE)
      if(is_guarded)
        list(APPEND guarded ${header})
      endif()
    endif()
  endforeach()
endwhile()
if(pending)
  list(JOIN pending ", " circle)
  string(APPEND complaints "  these headers include each other in a circle: ${circle}\n")
endif()
foreach(header IN LISTS headers)
  if(NOT pending AND NOT header MATCHES "/(internal|kernels)/|-inl[.]h$" AND NOT header STREQUAL guard
      AND NOT header IN_LIST guarded)
    string(APPEND complaints "  ${header} does not include ${guard}, nor does what it includes\n")
  endif()
endforeach()

# Headers for one instruction set, x-inl.h, are compiled by their kernels only.
set(alone ${headers})
list(REMOVE_ITEM alone ${proven})
list(FILTER alone EXCLUDE REGEX "-inl[.]h$|/kernels/|^base/wide")
foreach(header IN LISTS alone)
  file(WRITE ${SCRATCH}/alone.cpp "#include \"earshot/${header}\"\n")
  execute_process(
    COMMAND ${COMPILER} -std=c++20 -fsyntax-only ${include_flags} ${SCRATCH}/alone.cpp
    RESULT_VARIABLE status ERROR_VARIABLE error)
  if(NOT status EQUAL 0)
    string(APPEND complaints "  ${header} does not compile alone:\n${error}\n")
  endif()
endforeach()

if(complaints)
  message(FATAL_ERROR "includes:\n${complaints}")
endif()
list(LENGTH headers count)
list(LENGTH alone alone_count)
message(STATUS "${count} headers, ${alone_count} compiled alone: no circle, none against the order")

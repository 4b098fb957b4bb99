# Fails if a folder's README.md leaves out a header or source of the folder (or of its sub-folders),
# or names one that does not exist. Names stand in backticks: `x.h`, `internal/x.cpp`, `x.*`,
# `x_*.cpp`. A name without a folder stands for files of that name anywhere below the README.
# Arguments: SOURCE_DIR, FOLDERS (joined by commas).
cmake_minimum_required(VERSION 3.25)
string(REPLACE "," ";" folders "${FOLDERS}")
set(complaints)

# The regular expression of a name with wildcards.
function(expression_of name out)
  string(REPLACE "." "[.]" name "${name}")
  string(REPLACE "*" "[^/]*" name "${name}")
  set(${out} "^(.*/)?${name}$" PARENT_SCOPE)
endfunction()

foreach(folder IN LISTS folders)
  file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR}/${folder}
    ${SOURCE_DIR}/${folder}/*.h ${SOURCE_DIR}/${folder}/*.cpp ${SOURCE_DIR}/${folder}/*.ts)
  list(FILTER files EXCLUDE REGEX "^(node_modules|dist|tests)/")
  if(NOT EXISTS ${SOURCE_DIR}/${folder}/README.md OR NOT files)
    message(FATAL_ERROR "${folder}/ has no README.md or no sources")
  endif()
  file(READ ${SOURCE_DIR}/${folder}/README.md text)
  # Brackets and semicolons mean something in CMake lists; names have neither.
  string(REGEX REPLACE "[][;]" " " text "${text}")
  string(REPLACE "```" "" text "${text}")
  string(REGEX MATCHALL "`[^`\n]+`" names "${text}")
  list(TRANSFORM names REPLACE "`" "")
  list(FILTER names INCLUDE REGEX "^[a-z0-9_/*-]+[.](h|cpp|ts|[*])$")
  list(FILTER names EXCLUDE REGEX "^x[.]")  # the placeholder in explanations
  list(REMOVE_DUPLICATES names)

  set(unnamed ${files})
  foreach(name IN LISTS names)
    expression_of("${name}" expression)
    set(named ${files})
    list(FILTER named INCLUDE REGEX "${expression}")
    list(FILTER unnamed EXCLUDE REGEX "${expression}")
    if(NOT named AND NOT EXISTS ${SOURCE_DIR}/${name})
      string(APPEND complaints "  ${folder}/README.md names `${name}`, which is not there\n")
    endif()
  endforeach()
  foreach(file IN LISTS unnamed)
    string(APPEND complaints "  ${folder}/README.md does not name ${file}\n")
  endforeach()
endforeach()
if(complaints)
  message(FATAL_ERROR "READMEs and files differ:\n${complaints}")
endif()
message(STATUS "the READMEs of ${FOLDERS} name their files")

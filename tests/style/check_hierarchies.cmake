# Fails if a source outside of bvh/ builds or refits a tree by itself: hierarchies are kept by
# bvh::DeformableBvh, whose policy chooses between refit, repair and rebuild, and lent by its view().
# Tests and benchmarks of the trees themselves may; so may the report of 'earshot bvh', which
# compares what refits and rebuilds cost. Arguments: SOURCE_DIR, FOLDERS.
set(calls "[^A-Za-z](Wide)?Tree::build *\\(" "(\\.|->)refit *\\(" "optimise_by_reinsertion *\\("
  "build_grouped *\\(" "bvh::(PartialRefit|Instances)")
set(exceptions cli/hierarchy_report.cpp)

string(REPLACE "," ";" FOLDERS "${FOLDERS}")
list(REMOVE_ITEM FOLDERS bvh)
set(failures "")
set(count 0)
set(keepers "")
foreach(folder IN LISTS FOLDERS)
  file(GLOB_RECURSE sources RELATIVE ${SOURCE_DIR}
    ${SOURCE_DIR}/${folder}/*.h ${SOURCE_DIR}/${folder}/*.cpp)
  foreach(source IN LISTS sources)
    math(EXPR count "${count} + 1")
    file(READ ${SOURCE_DIR}/${source} text)
    string(REGEX REPLACE "//[^\n]*" "" code "${text}")
    if(code MATCHES "DeformableBvh")
      list(APPEND keepers ${source})
    endif()
    list(FIND exceptions ${source} exception)
    if(NOT exception EQUAL -1)
      continue()
    endif()
    foreach(call IN LISTS calls)
      if(code MATCHES "${call}")
        string(APPEND failures "${source}: ${CMAKE_MATCH_0}\n")
      endif()
    endforeach()
  endforeach()
endforeach()
if(count EQUAL 0)
  message(FATAL_ERROR "no sources found")
endif()
if(failures)
  message(FATAL_ERROR "hierarchies built or refitted outside of bvh::DeformableBvh:\n${failures}")
endif()
list(LENGTH keepers keeper_count)
message(STATUS "${count} sources: none builds or refits a tree outside of bvh::DeformableBvh, "
  "which ${keeper_count} files name")

# earshot_sanitized(TARGET): the sources of a library or program once more as TARGET_sanitized, under the address and
# undefined-behaviour sanitizers. earshot_sanitized_tests(FOLDER [TEST...]): the objects of a test program, linked with
# the sanitized libraries; the TESTs are left out. They are of what meets untrusted files; all else is the plain
# build's. Call them where TARGET is made, libraries before programs. Built by the target earshot_sanitized_tests, run by
# `ctest -C Sanitized -L sanitized`; `scripts/test --sanitized` does both.
include_guard()
set(EARSHOT_SANITIZERS -fsanitize=address,undefined -fno-sanitize-recover=all)
# Whole, so that the linker finds every symbol in them before it looks into the plain ones.
set(EARSHOT_SANITIZED_LIBRARIES
  "$<LINK_LIBRARY:WHOLE_ARCHIVE,earshot_io_sanitized,earshot_geometry_sanitized,earshot_base_sanitized>")
add_custom_target(earshot_sanitized_tests)

# Links what TARGET links, and the sanitized libraries before it.
function(earshot_link_sanitized sanitized target)
  get_target_property(libraries ${target} LINK_LIBRARIES)
  target_link_libraries(${sanitized} PRIVATE ${EARSHOT_SANITIZED_LIBRARIES} ${libraries})
  target_link_options(${sanitized} PRIVATE ${EARSHOT_SANITIZERS})
endfunction()

function(earshot_sanitized target)
  get_target_property(type ${target} TYPE)
  get_target_property(sources ${target} SOURCES)
  get_target_property(libraries ${target} LINK_LIBRARIES)
  set(sanitized ${target}_sanitized)
  if(type STREQUAL "EXECUTABLE")
    add_executable(${sanitized} EXCLUDE_FROM_ALL ${sources})
    earshot_link_sanitized(${sanitized} ${target})
    add_dependencies(earshot_sanitized_tests ${sanitized})
  else()
    add_library(${sanitized} STATIC EXCLUDE_FROM_ALL ${sources})
    if(libraries)
      target_link_libraries(${sanitized} PUBLIC ${libraries})
    endif()
  endif()
  target_include_directories(${sanitized} PRIVATE $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
  target_compile_definitions(${sanitized} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_DEFINITIONS>)
  # O1 is built faster than O2.
  target_compile_options(${sanitized} PRIVATE ${EARSHOT_SANITIZERS} -O1 -g0 -fno-omit-frame-pointer)
endfunction()

# Of memory, a single allocation and the whole have limits; the fuzzed readers are held to them.
function(earshot_add_sanitized_test folder program)
  list(JOIN ARGN ":" left_out)
  add_test(NAME sanitized.${folder} CONFIGURATIONS Sanitized
    COMMAND ${program} --gtest_brief=1 --gtest_filter=-*Slow*:${left_out})
  set(environment ASAN_OPTIONS=max_allocation_size_mb=2048:hard_rss_limit_mb=3072)
  if(folder STREQUAL "cli")
    list(APPEND environment EARSHOT_PROGRAM=$<TARGET_FILE:earshot_sanitized>)
  endif()
  set_tests_properties(sanitized.${folder} PROPERTIES
    LABELS sanitized TIMEOUT 1200 ENVIRONMENT "${environment}")
  add_dependencies(earshot_sanitized_tests ${program})
endfunction()

function(earshot_sanitized_tests folder)
  set(target earshot_tests_${folder})
  add_executable(${target}_sanitized EXCLUDE_FROM_ALL $<TARGET_OBJECTS:${target}>)
  set_target_properties(${target}_sanitized PROPERTIES LINKER_LANGUAGE CXX)
  earshot_link_sanitized(${target}_sanitized ${target})
  earshot_add_sanitized_test(${folder} ${target}_sanitized ${ARGN})
endfunction()

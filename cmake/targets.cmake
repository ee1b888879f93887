# stickslip_library(NAME [SOURCES ...] [PUBLIC ...] [PRIVATE ...] [BUNCH n]): one folder, one static library. BUNCH: sources
# that the presets with bunches compile at once; fewer than eight where their headers take long, so that an edit is built soon.
function(stickslip_library name)
  cmake_parse_arguments(ARG "" "BUNCH" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC stickslip_flags ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
    stickslip_precompiled(${name} stickslip_library_headers)
    if(ARG_BUNCH AND STICKSLIP_PRECOMPILED AND NOT STICKSLIP_BUILT_ONCE)
      set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE ${ARG_BUNCH})
    endif()
    # What is generated stays alone: clang-tidy reads bunches before anything is built.
    foreach(source ${ARG_SOURCES})
      if(source MATCHES "^${CMAKE_BINARY_DIR}/")
        set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      endif()
    endforeach()
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE stickslip_flags ${ARG_PUBLIC})
  endif()
endfunction()

# stickslip_test(NAME SOURCES ... LINK ... [LABELS ...] [TIMEOUT seconds] [SHARDS n]): one GoogleTest program, one CTest entry. SHARDS:
# n entries, NAME_1 to NAME_n, each of which runs every n-th test; for what runs long, so that all processors run it.
# The label "threads" marks what runs under ThreadSanitizer; the target threads_tests builds just that. "statistics" marks
# what repeats the same code over many random tests, "numeric" what compares it with references of many digits, "pages"
# what a browser shows, "documents" the commands of the documents: sanitizers would learn nothing new from them, and go without.
add_custom_target(threads_tests)
function(stickslip_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT;SHARDS" "SOURCES;LINK;LABELS" ${ARGN})
  if(STICKSLIP_SANITIZE AND ("statistics" IN_LIST ARG_LABELS OR "numeric" IN_LIST ARG_LABELS))
    return()
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gmock_main)
  stickslip_precompiled(${name} stickslip_test_headers)
  target_compile_definitions(${name} PRIVATE
    STICKSLIP_SOURCE_DIR="${CMAKE_SOURCE_DIR}" STICKSLIP_BINARY_DIR="${CMAKE_BINARY_DIR}")
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
    if(STICKSLIP_SANITIZE)
      set(ARG_TIMEOUT 600) # Sanitizers take ten times as long, on processors that others use as well.
    endif()
  endif()
  set(entries ${name})
  if(ARG_SHARDS)
    set(entries)
    foreach(number RANGE 1 ${ARG_SHARDS})
      list(APPEND entries ${name}_${number})
    endforeach()
  endif()
  set(index 0)
  foreach(entry ${entries})
    add_test(NAME ${entry} COMMAND ${name})
    set_tests_properties(${entry} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
    set(environment)
    if(ARG_SHARDS)
      list(APPEND environment GTEST_TOTAL_SHARDS=${ARG_SHARDS} GTEST_SHARD_INDEX=${index})
    endif()
    if(STICKSLIP_SANITIZE)
      list(APPEND environment RC_PARAMS=max_success=25) # A quarter of RapidCheck's cases: the others ask for what is right.
    endif()
    set_tests_properties(${entry} PROPERTIES ENVIRONMENT "${environment}")
    if(ARG_SHARDS OR "statistics" IN_LIST ARG_LABELS)
      set_tests_properties(${entry} PROPERTIES COST 60) # The longest: begun before the others.
    endif()
    math(EXPR index "${index} + 1")
  endforeach()
  if("threads" IN_LIST ARG_LABELS)
    add_dependencies(threads_tests ${name})
  endif()
endfunction()

# stickslip_embed(OUTPUT HEADER NAMESPACE NAME=FILE ...): text files become functions of a source, which HEADER declares.
function(stickslip_embed output header namespace)
  set(names)
  set(files)
  foreach(pair ${ARGN})
    string(REGEX MATCH "^([^=]+)=(.+)$" matched "${pair}")
    get_filename_component(file "${CMAKE_MATCH_2}" ABSOLUTE)
    list(APPEND names ${CMAKE_MATCH_1})
    list(APPEND files ${file})
  endforeach()
  list(JOIN names , names_joined)
  list(JOIN files , files_joined)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DHEADER=${header} -DNAMESPACE=${namespace} -DNAMES=${names_joined}
      -DFILES=${files_joined} -P ${CMAKE_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${files} ${CMAKE_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
endfunction()

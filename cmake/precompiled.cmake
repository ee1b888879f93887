# For presets that build everything anew: headers that nearly every source begins with are compiled once, and the
# sources of a target in bunches of eight, so that templates of Asio, JSON and Eigen are expanded once for eight sources.
# What it asks: two sources of one target may not give the same name to different things, not even in anonymous namespaces. The preset dev goes without, so that editing one
# source compiles one, and an include that is missing is seen; clang-tidy reads bunches, in a quarter of the time.
option(STICKSLIP_PRECOMPILED "Compile the common headers once, and sources in bunches" OFF)
if(NOT STICKSLIP_PRECOMPILED)
  function(stickslip_precompiled)
  endfunction()
  return()
endif()

# Where everything is built once, as by continuous integration and with sanitizers, nobody edits one source: a folder in one
# bunch takes a quarter to a third less of the compiler's time than in eights.
option(STICKSLIP_BUILT_ONCE "Sources in larger bunches: all of them are built sooner, an edit later" OFF)
if(STICKSLIP_SANITIZE)
  set(STICKSLIP_BUILT_ONCE ON)
endif()
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)
if(STICKSLIP_BUILT_ONCE)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 40)
endif()
# Tests are compiled more often than run, debugged with the preset dev, and compute little by themselves. So do the
# programs, which sanitizers build to be watched: Clang takes less than half of the time over them without
# optimisation. What computes is core. Without tests, as the preset fuzz-fast is, all of it is to run fast.
set(quick_options)
if(STICKSLIP_TESTS)
  set(quick_options -O0)
endif()
# What is shipped: over commands, requests, messages and pages GCC takes a quarter less with -O1. What scans pass through stays
# with the rest, and so do io and report, which read long files.
set(program_folders "cli|cli/(accuracy_report|doctor|manual)|daemon/(app|asio|batch|client|control|fleet|page|types)")
set(program_options -O1)
if(STICKSLIP_SANITIZE)
  set(program_folders "(daemon|io|report|cli|core/(record|accuracy|evaluation|daq))(/.*)?")
  set(program_options ${quick_options})
endif()

file(WRITE ${CMAKE_BINARY_DIR}/precompiled.cpp "// Only so that its headers are compiled.\n")
set(common_headers
  <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <random> <span>
  <string> <string_view> <variant> <vector> <fmt/format.h> <tl/expected.hpp> <Eigen/Core> <Eigen/Cholesky>
  <nlohmann/json.hpp>)

# Where a target defines a macro that these headers look at, GCC reads them anew, which is no mistake.
function(stickslip_precompiled_headers name)
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(${name} PRIVATE stickslip_flags fmt::fmt Eigen3::Eigen ${ARGN})
  target_compile_options(${name} PRIVATE -Wno-error=invalid-pch)
endfunction()

stickslip_precompiled_headers(stickslip_library_headers)
target_precompile_headers(stickslip_library_headers PRIVATE ${common_headers})
stickslip_precompiled_headers(stickslip_program_headers)
target_compile_options(stickslip_program_headers PRIVATE ${program_options})
target_precompile_headers(stickslip_program_headers PRIVATE ${common_headers})
if(STICKSLIP_TESTS)
  find_package(GTest REQUIRED)
  stickslip_precompiled_headers(stickslip_test_headers GTest::gmock)
  target_compile_options(stickslip_test_headers PRIVATE ${quick_options} -g0)
  target_precompile_headers(stickslip_test_headers PRIVATE ${common_headers} <gmock/gmock.h> <gtest/gtest.h>
    <rapidcheck.h>)
endif()

# stickslip_precompiled(NAME HEADERS): HEADERS is stickslip_library_headers, which become stickslip_program_headers in the
# folders of programs, or one of the others.
function(stickslip_precompiled name headers)
  if(headers STREQUAL stickslip_library_headers AND CMAKE_CURRENT_SOURCE_DIR MATCHES "^${CMAKE_SOURCE_DIR}/(${program_folders})$")
    set(headers stickslip_program_headers)
  endif()
  target_precompile_headers(${name} REUSE_FROM ${headers})
  target_link_libraries(${name} PRIVATE fmt::fmt Eigen3::Eigen) # What the headers need; else nothing changes.
  target_compile_options(${name} PRIVATE -Wno-error=invalid-pch)
  if(headers STREQUAL stickslip_program_headers)
    target_compile_options(${name} PRIVATE ${program_options})
  elseif(headers STREQUAL stickslip_test_headers)
    target_compile_options(${name} PRIVATE ${quick_options} -g0)
  endif()
endfunction()

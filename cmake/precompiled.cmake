# Headers that nearly every source begins with, compiled once: it halves the time of small sources. The presets dev
# and lint go without, so that clang-tidy shows an include that is missing.
option(STICKSLIP_PRECOMPILED "Compile the common headers once" OFF)
if(NOT STICKSLIP_PRECOMPILED)
  function(stickslip_precompiled)
  endfunction()
  return()
endif()

file(WRITE ${CMAKE_BINARY_DIR}/precompiled.cpp "// Only so that its headers are compiled.\n")
set(common_headers
  <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <random> <span>
  <string> <string_view> <variant> <vector> <fmt/format.h> <tl/expected.hpp> <Eigen/Core> <Eigen/Cholesky>)

# Where a target defines a macro that these headers look at, GCC reads them anew, which is no mistake.
function(stickslip_precompiled_headers name)
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(${name} PRIVATE stickslip_flags fmt::fmt Eigen3::Eigen ${ARGN})
  target_compile_options(${name} PRIVATE -Wno-error=invalid-pch)
endfunction()

stickslip_precompiled_headers(stickslip_library_headers)
target_precompile_headers(stickslip_library_headers PRIVATE ${common_headers})
find_package(GTest REQUIRED)
stickslip_precompiled_headers(stickslip_test_headers GTest::gmock)
target_precompile_headers(stickslip_test_headers PRIVATE ${common_headers} <gmock/gmock.h> <gtest/gtest.h>)

# stickslip_precompiled(NAME HEADERS): HEADERS is stickslip_library_headers or stickslip_test_headers.
function(stickslip_precompiled name headers)
  target_precompile_headers(${name} REUSE_FROM ${headers})
  target_link_libraries(${name} PRIVATE fmt::fmt Eigen3::Eigen) # What the headers need; else nothing changes.
  target_compile_options(${name} PRIVATE -Wno-error=invalid-pch)
endfunction()

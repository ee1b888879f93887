# Every target links this one interface; sanitizers come from the presets.
add_library(stickslip_flags INTERFACE)
target_include_directories(stickslip_flags INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(stickslip_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  # Live, replay and batch must give the same bits: the compiler may not fuse a*b+c.
  -ffp-contract=off)

# Fifty programs are linked; LLVM's linker takes a quarter of the time that GNU's does.
find_program(STICKSLIP_LLD ld.lld)
if(STICKSLIP_LLD)
  target_link_options(stickslip_flags INTERFACE -fuse-ld=lld)
endif()

# What is shipped is the same bits wherever it was built.
if(CMAKE_BUILD_TYPE STREQUAL RelWithDebInfo AND NOT STICKSLIP_SANITIZE)
  target_compile_options(stickslip_flags INTERFACE -ffile-prefix-map=${CMAKE_SOURCE_DIR}=.)
endif()

if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(stickslip_flags INTERFACE -Werror)
  if(CMAKE_BUILD_TYPE STREQUAL RelWithDebInfo AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # With -O3, GCC 12 takes strings of its own library for overlapping (GCC bug 105651, mended in 13). Not for the
    # preset lint, whose clang-tidy does not know that warning.
    target_compile_options(stickslip_flags INTERFACE -Wno-restrict)
  endif()
else()
  # Which warnings count is what the compiler of the shipped program says.
  target_compile_options(stickslip_flags INTERFACE -Wno-unknown-warning-option)
endif()

if(STICKSLIP_FUZZ AND STICKSLIP_SANITIZE)
  # Steps from one place of the program to the next are counted, which costs a few per cent.
  target_compile_options(stickslip_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

set(STICKSLIP_SANITIZE "" CACHE STRING "Sanitizers for -fsanitize=, e.g. address,undefined or thread")
if(STICKSLIP_SANITIZE)
  target_compile_options(stickslip_flags INTERFACE
    -fsanitize=${STICKSLIP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(stickslip_flags INTERFACE -fsanitize=${STICKSLIP_SANITIZE})
  if(STICKSLIP_SANITIZE MATCHES "undefined")
    # What reads or writes through a bad pointer AddressSanitizer finds as well; asked before each access, these
    # checks make compilers take three times as long over code that Eigen has expanded.
    target_compile_options(stickslip_flags INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
  endif()
endif()

/// \file
/// Contract checks: if a caller breaks a checked precondition, such as one marked "(contract)", the program
/// prints the place and aborts. Other preconditions are not checked.
/// Never used for bad input or failures of board and disk, which are values (result.hpp).
#pragma once

#include <cstdio>
#include <cstdlib>

namespace stickslip::base {

/// Prints the broken condition with its place and aborts.
[[noreturn]] inline void contract_broken(const char* condition, const char* file, int line) noexcept {
  std::fprintf(stderr, "stickslip: contract broken: %s at %s:%d\n", condition, file, line);
  std::abort();
}

}  // namespace stickslip::base

/// Prints the place and aborts if the condition is false. Checked in every build; costs one predicted branch.
#define STICKSLIP_EXPECTS(condition) \
  ((condition) ? static_cast<void>(0) : ::stickslip::base::contract_broken(#condition, __FILE__, __LINE__))

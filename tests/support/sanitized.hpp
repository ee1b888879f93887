/// \file
/// Is this build watched by a sanitizer? It runs ten times as slowly, and looks for faults of the code: tests
/// that repeat for the sake of statistics may then repeat less.
#pragma once

namespace stickslip::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace stickslip::test

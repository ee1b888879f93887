/// \file
/// Tests that repeat for the sake of statistics may repeat less where a sanitizer, which looks for faults of
/// the code, watches them.
#pragma once

#include "core/base/sanitized.hpp"

namespace stickslip::test {

inline constexpr bool kSanitized = base::kSanitized;

}  // namespace stickslip::test

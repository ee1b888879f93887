/// \file
/// Findings as text for people: the sentence, then code, severity and what to do.
///
///     !  test 3: the pull speed was 3.990 +- 0.012 in/min, the plan says 12 in/min
///        alike in 208 more: test 4–211
///        → pull-speed, warning: correct the tester's speed, or pull_speed of the plan
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/base/finding.hpp"

namespace stickslip::io {

/// "pull-speed, warning: correct the tester's speed, …"
[[nodiscard]] std::string action_text(const base::Finding& finding);

/// One line for the sentence and one for what to do, with `head` before the sentence.
[[nodiscard]] std::string finding_text(const base::Finding& finding, std::string_view head = "!  ");

struct TestFindings {
  std::int64_t number = 0;  ///< Of the test.
  std::span<const base::Finding> findings;
};

/// The findings of several tests: each code once, the most severe first, with the sentences of its first
/// three tests and the numbers of the others. Uncoded sentences all stand there.
[[nodiscard]] std::string findings_text(std::span<const TestFindings> tests);

}  // namespace stickslip::io

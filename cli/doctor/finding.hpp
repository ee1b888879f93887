/// \file
/// What `stickslip doctor` has to say of one thing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stickslip::doctor {

struct Finding {
  enum class Verdict {
    kGood,
    kUnknown,  ///< Not looked at, because something else has to be mended first.
    kWarning,  ///< It works; somebody should see to it.
    kBad,      ///< No test can be measured and kept as it is.
  };
  std::string check;  ///< One word, the same in all versions.
  Verdict verdict = Verdict::kGood;
  std::string what;   ///< One line.
  std::string to_do;  ///< Empty if good.
};

[[nodiscard]] constexpr std::string_view name(Finding::Verdict verdict) noexcept {
  switch (verdict) {
    case Finding::Verdict::kGood:
      break;
    case Finding::Verdict::kUnknown:
      return "unknown";
    case Finding::Verdict::kWarning:
      return "warning";
    case Finding::Verdict::kBad:
      return "bad";
  }
  return "good";
}

/// 0 all is good, 1 something is bad or could not be looked at, 3 there are warnings.
[[nodiscard]] inline int exit_status(const std::vector<Finding>& findings) noexcept {
  int status = 0;
  for (const Finding& finding : findings) {
    if (finding.verdict == Finding::Verdict::kBad || finding.verdict == Finding::Verdict::kUnknown) return 1;
    if (finding.verdict == Finding::Verdict::kWarning) status = 3;
  }
  return status;
}

}  // namespace stickslip::doctor

/// \file
/// A finding of `stickslip doctor`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stickslip::doctor {

struct Finding {
  enum class Verdict {
    kGood,
    kUnknown,  ///< Not checked: something else must be repaired first.
    kWarning,  ///< Tests work, but this should be repaired.
    kBad,      ///< Tests cannot be measured or recorded.
  };
  std::string check;  ///< Name of the check, one word; stable between versions.
  Verdict verdict = Verdict::kGood;
  std::string what;   ///< What was found, one line.
  std::string to_do;  ///< Remedy; empty if good.
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

/// Exit status: 1 if a finding is bad or unknown, else 3 if there is a warning, else 0.
[[nodiscard]] inline int exit_status(const std::vector<Finding>& findings) noexcept {
  int status = 0;
  for (const Finding& finding : findings) {
    if (finding.verdict == Finding::Verdict::kBad || finding.verdict == Finding::Verdict::kUnknown) return 1;
    if (finding.verdict == Finding::Verdict::kWarning) status = 3;
  }
  return status;
}

}  // namespace stickslip::doctor

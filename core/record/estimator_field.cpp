#include "core/record/estimator_field.hpp"

#include <optional>
#include <string_view>

#include "core/base/wording.hpp"

namespace stickslip::record {

base::Result<detect::EstimatorTier> estimator_of(const ProcessFacts& process) {
  if (process.estimator.empty()) return detect::EstimatorTier::kFit;
  const std::optional<detect::EstimatorTier> tier = detect::estimator_tier_from_name(process.estimator);
  if (!tier) {
    return base::usage_error("process/estimator \"{}\" is not \"turning-points\" or \"fit\"",
                             base::one_line(process.estimator, 100));
  }
  return *tier;
}

void read_estimator_of_0_1(ProcessFacts& process) {
  constexpr std::string_view kKey = " estimator=";
  const std::string_view text = process.method;
  const std::size_t at = text.find(kKey);
  if (at == std::string_view::npos || !process.estimator.empty()) return;
  const std::string_view value = text.substr(at + kKey.size());
  const std::string_view word = value.substr(0, value.find(' '));
  if (!detect::estimator_tier_from_name(word)) return;
  process.estimator = word;
  process.method.erase(at, kKey.size() + word.size());
}

}  // namespace stickslip::record

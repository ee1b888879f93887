#include "daemon/types/verdict.hpp"

namespace stickslip::daemon {

LimitVerdict judged(const std::string& quantity, const ResultLimits& limits,
                    std::span<const analysis::MeasuredTest> tests) {
  LimitVerdict verdict{quantity, limits, {}, {}};
  for (std::size_t i = 0; i < tests.size(); ++i) {
    analysis::for_each_result(tests[i].results,
                              [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
                                if (name.name != quantity) return;
                                if (!estimate.value) {
                                  verdict.absent.push_back(i);
                                } else if (!limits.holds(*estimate.value)) {
                                  verdict.outside.push_back(i);
                                }
                              });
  }
  return verdict;
}

}  // namespace stickslip::daemon

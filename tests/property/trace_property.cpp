// The search for a scan by its time, against the standard library's: from wherever it begins, with scans that
// are missing, with times on scans, between them and outside.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

#include "core/estimate/trace.hpp"

namespace stickslip::estimate {
namespace {

RC_GTEST_PROP(TraceProperty, AScanIsFoundByItsTimeWhereverTheSearchBegins, ()) {
  const auto steps = *rc::gen::container<std::vector<int>>(rc::gen::inRange(1, 5));
  Trace trace;
  double time_s = 0.0;
  std::vector<double> times;
  for (const int step : steps) {
    time_s += 0.25 * step;
    times.push_back(time_s);
    trace.time_s.push_back(time_s);
    trace.value.push_back(0.3);
  }
  const double wanted_s = 0.125 * *rc::gen::inRange(-4, static_cast<int>(8.0 * time_s) + 8);
  const auto near = *rc::gen::inRange<std::size_t>(0, steps.size() + 3);
  const auto expected =
      static_cast<std::size_t>(std::lower_bound(times.begin(), times.end(), wanted_s) - times.begin());
  RC_ASSERT(scan_at_or_after(trace, wanted_s, near) == expected);
}

}  // namespace
}  // namespace stickslip::estimate

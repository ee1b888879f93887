/// \file
/// A material for reports.
#pragma once

#include <fmt/format.h>

#include "core/friction/results.hpp"
#include "core/report/grouping.hpp"
#include "daemon/report/test_report.hpp"

namespace stickslip::test {

/// Three tests at one speed, the third without a static coefficient and not as its method asks.
inline daemon::Material sample_material() {
  daemon::Material material;
  for (int i = 0; i < 3; ++i) {
    report::MeasuredTest test;
    test.pull_speed_m_per_s = 0.00508;
    friction::for_each_result(test.results,
                              [](const friction::ResultName& /*name*/, friction::Estimate& estimate) {
                                estimate = friction::Estimate::none("not asked");
                              });
    if (i < 2) test.results.static_coefficient = friction::Estimate::of(0.38 + 0.01 * i);
    material.measured.push_back(test);
    daemon::ReportedTest reported;
    reported.file = fmt::format("f{}.h5", i);
    reported.method = "own kinetic_cycles=3";
    reported.trace = "{}";
    material.tests.push_back(reported);
  }
  material.tests[2].departures = {"pull speed is other"};
  material.groups = report::group_by_speed(material.measured);
  return material;
}

}  // namespace stickslip::test

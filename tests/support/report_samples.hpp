/// \file
/// A material for reports.
#pragma once

#include <fmt/format.h>

#include "report/test_report.hpp"

#include "core/analysis/grouping.hpp"
#include "core/analysis/results.hpp"

namespace stickslip::test {

/// Three tests at one speed, the third without a static coefficient and not as its method asks.
inline report::Material sample_material() {
  report::Material material;
  for (int i = 0; i < 3; ++i) {
    analysis::MeasuredTest test;
    test.pull_speed_m_per_s = 0.00508;
    analysis::for_each_result(test.results,
                              [](const analysis::ResultName& /*name*/, analysis::Estimate& estimate) {
                                estimate = analysis::Estimate::none("not asked");
                              });
    if (i < 2) test.results.static_coefficient = analysis::Estimate::of(0.38 + 0.01 * i);
    material.measured.push_back(test);
    report::ReportedTest reported;
    reported.file = fmt::format("f{}.h5", i);
    reported.method = "own kinetic_cycles=3";
    reported.trace = "{}";
    reported.speed = "12 in/min";
    material.tests.push_back(reported);
  }
  material.tests[2].departures = {"pull speed is other"};
  material.groups = analysis::group_by_speed(material.measured);
  return material;
}

}  // namespace stickslip::test

/// \file
/// What the results of tests say about the friction law, and which tests say nothing.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/analysis/grouping.hpp"
#include "core/law/friction_law.hpp"

namespace stickslip::law {

/// A coefficient of a test that does not count.
struct LeftOut {
  std::size_t test = 0;  ///< Index among all tests.
  std::string what;      ///< "S", "K" or "S and K".
  std::string reason;    ///< For people.
};

struct LawTests {
  std::vector<LawTest> tests;
  std::vector<std::size_t> measured;  ///< Index of each among all tests; never falls.
  std::vector<LeftOut> left_out;
};

/// Rules, in this order:
///
/// - A test counts for nothing with a finding that is a fault, scans that another test has too, or no known
///   speed.
/// - A test that changes its speed counts by its rests, each of them as a test: four or more slips at one
///   speed, and each slip after a hold. Their S is K + (S − K), with K the mean at their speed: levels wander
///   along the track, S − K does not. Without such rests, as on a ramp, it counts for nothing.
/// - S needs a stick time: slips after the first that begin from a stick.
/// - K of a test that slides steadily is its kinetic coefficient.
/// - By turning points, the systematic part is a correction of its own in each test: it joins the error.
/// - A value without an error has the largest of the others'.
[[nodiscard]] LawTests tests_for_law(std::span<const analysis::MeasuredTest> measured);

}  // namespace stickslip::law

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
  std::size_t test = 0;  ///< Index among all tests, those given to tests_for_law().
  std::string what;      ///< "S", "K" or "S and K".
  std::string reason;    ///< For people.
};

/// Input of find_law(), with its origin.
struct LawTests {
  std::vector<LawTest> tests;
  std::vector<std::size_t> measured;  ///< For each of `tests` its index among all tests; never falls.
  std::vector<LeftOut> left_out;
};

/// Turns results into the input of find_law(), by these rules in this order:
///
/// - A test counts for nothing with a finding that is a fault, or scans that another test has too.
/// - A test with holds or several speeds counts by its rests, each of them as a test: four or more slips at
///   one speed, and each slip after a hold, which has no K. S and K are those of analysis::group_by_rest().
///   A test of several speeds without such rests, as a ramp, counts for nothing. A test of one speed whose
///   rests hold no slip after a hold counts as any other.
/// - Any other test counts for nothing without a known pull speed.
/// - S needs a stick time: slips after the first that begin from a stick.
/// - K of a test that slides steadily is its kinetic coefficient where it has no other K.
/// - By turning points, the systematic part is a correction of its own in each test: it joins the error. In
///   tests by rests it stays systematic.
/// - A value without an error has the largest of the others', or 1e-6 if none has one; that of a rest has
///   1e-6.
[[nodiscard]] LawTests tests_for_law(std::span<const analysis::MeasuredTest> measured);

}  // namespace stickslip::law

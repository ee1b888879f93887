/// \file
/// Several tests of one paper as one: S − K pooled by cycle.
///
///     const PooledDeltaMu pooled = pool_delta_mu(cycles_of_each_test);
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/friction/cycle.hpp"
#include "core/friction/results.hpp"

namespace stickslip::friction {

struct PooledDeltaMu {
  Estimate mean;                  ///< Over the slips of all tests, each counted once.
  Estimate scatter;               ///< Standard deviation from slip to slip.
  std::size_t slip_count = 0;     ///< Slips with an S − K.
  std::size_t escaped_count = 0;  ///< Those among them that did not end in sticking.
  Estimate captured_mean;         ///< Over the slips that stuck again alone: biased where some escape.
};

/// A slip whose S − K is small against the speed does not stick again and ends its test's stick-slip: it must
/// be counted, and by cycle. Slips that stuck again alone are chosen for a large S − K; a mean of the tests'
/// means gives the tests that an early escape cut short the weight of long ones. Slips up to and with the
/// first escape are a sequence that stops by what it has shown so far, so that their sum over their number
/// has no such bias [Wald, Ann. Math. Stat. 15:283–296, 1944].
///
/// The first slip of a pull is left out unless `with_first`: it is often not representative [Penner 1995].
/// The standard error is that of a ratio of sums over tests, since slips of one test share the errors of ω, γ
/// and the stick rate [Cochran, Sampling Techniques, 3rd ed. 1977, (2.46)]; it needs two tests.
/// \param tests  rows of TestAnalysis::cycles(); slips without S − K do not count.
[[nodiscard]] PooledDeltaMu pool_delta_mu(std::span<const std::vector<Cycle>> tests, bool with_first = false);

}  // namespace stickslip::friction

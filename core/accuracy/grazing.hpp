/// \file
/// Test of the methods near the threshold: just below it the sled still reaches the belt's speed and sticks,
/// just above it does not and the oscillation decays. The table shows down to which distance each method is
/// correct.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/accuracy/comparison.hpp"
#include "core/accuracy/method.hpp"

namespace stickslip::accuracy {

/// The methods are tested at Q = Q_th(1 ∓ 10⁻ⁿ), n = 1 … kFinestStep.
inline constexpr int kFinestStep = 13;

/// Verdict on a method at Q_th(1 ∓ 10⁻ⁿ), by goes_on() on each side; captures are not counted.
enum class Grazing {
  kFound,     ///< Goes on below, decays above: correct.
  kMissed,    ///< Decays on both sides: the capture below was missed.
  kFalse,     ///< Goes on on both sides: a false capture above.
  kReversed,  ///< Goes on above and decays below: both errors.
  kUndecided  ///< The method reports it as undecided, on at least one side.
};
[[nodiscard]] std::string_view name(Grazing grazing) noexcept;

struct GrazingRow {
  std::string method;
  std::string setting;
  std::array<Grazing, kFinestStep> steps{};  ///< n = 1 first.
};

/// A sled of this damping at this Q: 20 Hz, S − K 0.05, unloaded at the start, on a belt of constant speed. K
/// is the larger of 0.30 and 0.15 Q, so that the belt, which starts at once, takes the sled along.
/// \param gamma_over_2omega  > 0.
/// \param Q  > 0.
[[nodiscard]] sim::Motion grazing_motion(double gamma_over_2omega, double Q);

enum class GoesOn { kYes, kNo, kUndecided };

/// Whether the oscillation persists: its range exceeds half of the first one after so many cycles that a
/// ring-down would be well below that. kUndecided if the method reports an undecided capture.
/// \throws std::runtime_error if the method gives up; so do grazing_table() and apparent_threshold().
/// \param method  its lacks() is empty for grazing_motion().
/// \param gamma_over_2omega  > 0.
/// \param Q  > 0.
[[nodiscard]] GoesOn goes_on(const Method& method, double gamma_over_2omega, double Q);

/// Verdicts on the methods, one row each, in their order.
/// \param gamma_over_2omega  0.005 … 1: below that a ring-down lasts too long.
/// \param methods  their lacks() is empty for grazing_motion().
[[nodiscard]] std::vector<GrazingRow> grazing_table(double gamma_over_2omega,
                                                    std::span<const std::unique_ptr<Method>> methods,
                                                    const Progress& progress = {});

/// Q at which this method's oscillation begins to decay, by bisection. Undecided counts as decaying.
/// \param low,high  the oscillation persists at low and decays at high.
/// \param width  final width of the bracket, > 1e-15 high: one below rounding is never reached.
[[nodiscard]] double apparent_threshold(const Method& method, double gamma_over_2omega, double low,
                                        double high, double width);

}  // namespace stickslip::accuracy

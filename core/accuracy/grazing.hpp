/// \file
/// The decisive event: a hair below the threshold the sled still reaches the belt's speed and sticks, a hair
/// above it does not, and the oscillation dies. Which methods see the difference, and down to where?
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/accuracy/comparison.hpp"
#include "core/accuracy/method.hpp"

namespace stickslip::accuracy {

/// Q = Q_th(1 ∓ 10⁻ⁿ), n = 1 … kFinestStep.
inline constexpr int kFinestStep = 13;

enum class Grazing {
  kFound,     ///< Sticks for ever below, dies above.
  kMissed,    ///< Dies on both sides: the capture below was stepped over.
  kFalse,     ///< Sticks for ever on both sides: one above that is not there.
  kReversed,  ///< Both.
  kUndecided  ///< The method itself calls it too close to tell, on one side at least.
};
[[nodiscard]] std::string_view name(Grazing grazing) noexcept;

struct GrazingRow {
  std::string method;
  std::string setting;
  std::array<Grazing, kFinestStep> steps{};  ///< n = 1 first.
};

/// A sled of this damping that starts from rest and unloaded, at Q of S − K = 0.05.
/// \param gamma_over_2omega > 0. \param Q > 0.
[[nodiscard]] sim::Motion grazing_motion(double gamma_over_2omega, double Q);

enum class GoesOn { kYes, kNo, kUndecided };

/// Does the oscillation of this motion still go on, at more than half its first range, after so many cycles
/// that a ring-down would be well below that?
[[nodiscard]] GoesOn goes_on(const Method& method, double gamma_over_2omega, double Q);

/// \param gamma_over_2omega  0.005 … 1: of less, a ring-down lasts too long.
[[nodiscard]] std::vector<GrazingRow> grazing_table(double gamma_over_2omega,
                                                    std::span<const std::unique_ptr<Method>> methods,
                                                    const Progress& progress = {});

/// Q at which this method's oscillation dies, by bisection.
/// \param low,high  goes on at low and dies at high. \param width  of what is left of them, > 0.
[[nodiscard]] double apparent_threshold(const Method& method, double gamma_over_2omega, double low,
                                        double high, double width);

}  // namespace stickslip::accuracy

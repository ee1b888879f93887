/// \file
/// Interface of the methods for computing a motion that `stickslip accuracy` compares.
///
///     std::vector<double> coefficient(3500);
///     for (const auto& method : shipped_methods())
///       if (method->lacks(motion).empty()) (void)method->run(motion, 350.0, 1, coefficient);
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/sim/motion.hpp"

namespace stickslip::accuracy {

/// Results of a run beside the coefficient.
struct RunOutcome {
  /// Slips that ended because the sled reached the belt's speed; for smoothed friction see make_tanh().
  std::int64_t capture_count = 0;
  std::int64_t undecided_count = 0;  ///< Captures, found or not, that the method reports as undecided.
};

/// A method for computing a motion. Stateless. Thread-safe.
class Method {
 public:
  virtual ~Method() = default;

  /// Name of the method; rows with one name form one curve.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// Accuracy setting: tolerance, step or width; empty if there is none.
  [[nodiscard]] virtual std::string setting() const = 0;
  /// Feature of this motion that the method does not support; empty if it supports all.
  [[nodiscard]] virtual std::string_view lacks(const sim::Motion& motion) const noexcept = 0;
  /// Computes the coefficient at scans 0, 1, … up to the end of `coefficient`.
  /// \param motion  lacks() is empty.
  /// \param scan_rate_Hz  > 0.
  /// \param seed  of the motion's random numbers.
  /// \throws std::runtime_error if the method gives up, as CVODE may.
  virtual RunOutcome run(const sim::Motion& motion, double scan_rate_Hz, std::uint64_t seed,
                         std::span<double> coefficient) const = 0;
};

/// The method of closed forms, sim::Propagator.
[[nodiscard]] std::unique_ptr<Method> make_exact();
/// sim::NumericSolver: SUNDIALS CVODE with root finding and our test of grazing.
/// \param accuracy 1e-12 … 1e-2.
[[nodiscard]] std::unique_ptr<Method> make_cvode(double accuracy);
/// Boost.odeint's Dormand–Prince 5(4), and its extrapolation by Bulirsch and Stoer of order up to 16, in
/// steps of their own. An event, c′ reaching the belt's rate or c reaching zero, is looked for in the dense
/// output, also at the extremes of c′ and c within a step.
/// \param tolerance  > 0, absolute and relative, of a step.
[[nodiscard]] std::unique_ptr<Method> make_dormand_prince(double tolerance);
[[nodiscard]] std::unique_ptr<Method> make_bulirsch_stoer(double tolerance);
/// Semi-implicit (symplectic) Euler. A sled that passes the belt's speed in a step sticks if static friction
/// holds it, else it slides on at the other side of that speed.
/// \param steps_per_scan ≥ 1
[[nodiscard]] std::unique_ptr<Method> make_euler(int steps_per_scan);
/// ρ of make_tanh(): Stribeck's speed over the width w. With 3 the largest friction is K + 0.43 (S − K) for
/// S 0.35, K 0.30; with 10 it is K + 0.88 (S − K), but weakens over more of the belt's speed.
inline constexpr double kStribeckOverTanh = 3.0;

/// Smoothed friction, with which the sled never sticks, solved by Runge–Kutta of order 4:
///     μ(V) = (K + (S − K) e^(−(V/ρw)²)) tanh(V/w).
/// [the usual combination of Stribeck's curve and tanh: Andersson, Söderberg and Björklund, Tribology
///  International 40(4):580–587, 2007, (8)]
/// A capture is counted where the speeds differ by less than w, having differed by more than ρw.
/// \param width  w over the belt's fastest speed, > 0; the step follows from it by stability.
[[nodiscard]] std::unique_ptr<Method> make_tanh(double width, double stribeck_over_tanh = kStribeckOverTanh);

/// All methods above, each at the settings that `stickslip accuracy` shows; the exact one first.
[[nodiscard]] std::vector<std::unique_ptr<Method>> shipped_methods();

}  // namespace stickslip::accuracy

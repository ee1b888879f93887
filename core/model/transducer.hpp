/// \file
/// Dynamics of what lies between the force and its samples: the load cell's natural oscillation, and a
/// low-pass filter before the converter.
///
///     TransducerResponse response{transducer, step_s};
///     response.settle(0.30, 0.5);
///     for (const double force : forces) read.push_back(response.next(force));
#pragma once

#include <optional>
#include <vector>

namespace stickslip::model {

/// A load cell that swings: y″ + 2ζω y′ + ω² y = ω² x, where x is the force and y what the cell shows.
struct LoadCellDynamics {
  double frequency_Hz = 0.0;   ///< ω/2π, natural, without damping; > 0.
  double damping_ratio = 0.0;  ///< ζ ≥ 0
};

/// A Butterworth low-pass; of order 1 it is an RC filter.
struct AntiAlias {
  static constexpr int kHighestOrder = 8;
  double cutoff_Hz = 0.0;  ///< Where the gain is 1/√2; > 0.
  int order = 1;           ///< 1 … kHighestOrder
};

/// Order of an anti-alias filter where it is not stated.
inline constexpr int kTypicalFilterOrder = 4;
/// Damping ratio of a load cell on strain gauges where it is not stated.
inline constexpr double kTypicalCellDamping = 0.05;
/// Largest damping ratio of a load cell that can be stated for a fit: above it a cell does not ring.
inline constexpr double kLargestCellDamping = 0.99;

/// Lowest and highest frequency of a transducer that can be stated for a fit; both are allowed.
inline constexpr double kSlowestTransducer_Hz = 0.1;
inline constexpr double kFastestTransducer_Hz = 1e6;

/// What lies between the force and its samples, as far as it is known.
struct Transducer {
  std::optional<LoadCellDynamics> load_cell;
  std::optional<AntiAlias> anti_alias;

  /// It shows the force as it is.
  [[nodiscard]] bool is_ideal() const noexcept { return !load_cell && !anti_alias; }
  /// Whether frequencies, damping (at most kLargestCellDamping) and order are in their ranges.
  [[nodiscard]] bool is_valid() const noexcept;
};

/// What a transducer shows of a force that is known at equal steps and straight between them, in the force's
/// unit. At first it is at rest under no force. What one section of the transducer hands to the
/// next counts as straight, too: exact for a single section. The simulator has one of its own
/// (core/sim/transducer.hpp), exact for closed forms, by which fits are judged.
class TransducerResponse {
 public:
  /// \param transducer  valid (contract). \param step_s  > 0 (contract).
  TransducerResponse(const Transducer& transducer, double step_s);

  /// Begins anew, as after a long time on a line: the force is `value` now and rises by `rate_per_s`.
  void settle(double value, double rate_per_s) noexcept;
  /// One step later. \param value  the force there. \return what is shown there.
  double next(double value) noexcept;
  /// By so much a force on a line is shown late, and a slow oscillation nearly so; 0 if ideal.
  [[nodiscard]] double lag_s() const noexcept;
  /// What is shown now.
  [[nodiscard]] double shown() const noexcept;

 private:
  /// y″ + 2ζω y′ + ω² y = ω² x; or y′ + ω y = ω x, in which y′ counts for nothing.
  struct Section {
    double lag_s;        ///< By so much a line is shown late.
    double decay[2][2];  ///< Of (y, y′) about the line, over a step.
    double value = 0.0;
    double rate_per_s = 0.0;
  };
  void add_first_order(double frequency_Hz);
  void add_second_order(double frequency_Hz, double damping_ratio);

  double step_s_;
  double input_ = 0.0;
  std::vector<Section> sections_;  ///< In the order of the signal.
};

}  // namespace stickslip::model

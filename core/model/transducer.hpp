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

/// Lowest and highest order of the anti-alias filter; it is even.
inline constexpr int kLowestFilterOrder = 2;
inline constexpr int kHighestFilterOrder = 8;
inline constexpr int kTypicalFilterOrder = 4;
/// Damping of a load cell on strain gauges, over the critical one, where it is not stated.
inline constexpr double kTypicalCellDamping = 0.05;
/// Largest damping that can be stated: above it a cell does not ring.
inline constexpr double kLargestCellDamping = 0.99;

/// A transducer as its maker states it. One without frequencies is ideal: it shows the force as it is.
struct Transducer {
  std::optional<double> load_cell_frequency_Hz;    ///< Undamped natural frequency, > 0.
  double load_cell_damping = kTypicalCellDamping;  ///< Over the critical one, 0 to kLargestCellDamping.
  std::optional<double> anti_alias_Hz;         ///< Frequency at which a Butterworth low-pass takes 3 dB, > 0.
  int anti_alias_order = kTypicalFilterOrder;  ///< Even, kLowestFilterOrder to kHighestFilterOrder.

  [[nodiscard]] bool is_ideal() const noexcept { return !load_cell_frequency_Hz && !anti_alias_Hz; }
  /// Whether all numbers are in these ranges.
  [[nodiscard]] bool is_valid() const noexcept;
};

/// What a transducer shows of a force that is known at equal steps and straight between them. Exact for such
/// a force.
class TransducerResponse {
 public:
  /// \param step_s  > 0.
  TransducerResponse(const Transducer& transducer, double step_s);

  /// Begins anew, as after a long time on a line: the force is `value` now and rises by `rate_per_s`.
  void settle(double value, double rate_per_s) noexcept;
  /// One step later. \param value  the force there. \return what is shown there.
  double next(double value) noexcept;
  /// By so much a force on a line is shown late, and a slow oscillation nearly so.
  [[nodiscard]] double lag_s() const noexcept;
  /// What is shown now.
  [[nodiscard]] double shown() const noexcept;

 private:
  /// y″ + 2ζw y′ + w² y = w² x.
  struct Section {
    double lag_s;        ///< 2ζ/w: by so much a line is shown late.
    double decay[2][2];  ///< Of (y, y′) about the line, over a step.
    double value = 0.0;
    double rate_per_s = 0.0;
  };
  void add_section(double frequency_Hz, double damping);

  double step_s_;
  double input_ = 0.0;
  std::vector<Section> sections_;  ///< In the order of the signal.
};

}  // namespace stickslip::model

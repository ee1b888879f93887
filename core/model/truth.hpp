/// \file
/// Truth of a simulated test, to compare results with. Scenes and records made from scenes have one; a bench
/// has none.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/base/long_column.hpp"
#include "core/base/scan_index.hpp"
#include "core/model/regime.hpp"

namespace stickslip::model {

enum class Mode { kStick, kSlip, kSlack };

[[nodiscard]] constexpr const char* name(Mode mode) noexcept {
  switch (mode) {
    case Mode::kStick:
      return "stick";
    case Mode::kSlip:
      return "slip";
    case Mode::kSlack:
      return "slack";
  }
  return "stick";
}

/// Interval of time spent in one mode; seconds after the first scan of the record.
struct ModeInterval {
  double start_s = 0.0;
  double end_s = 0.0;
  Mode mode = Mode::kStick;
};

/// True S and K of one slip.
struct TrueCycle {
  double onset_time_s = 0.0;  ///< Seconds after the first scan of the record.
  double mu_s = 0.0;
  double mu_k = 0.0;
};

/// How the true motion was computed, and its accuracy.
struct SolverFacts {
  std::string method;                     ///< For people.
  double accuracy = 0.0;                  ///< Expected largest error of the coefficient.
  double accuracy_asked = 0.0;            ///< Accuracy that the scene asked for, in the same unit.
  std::optional<double> time_per_scan_s;  ///< Of computing; nullopt if not measured.

  bool operator==(const SolverFacts&) const = default;
};

struct TestTruth {
  std::string scene_name;
  std::string scene_text;  ///< Complete text of the scene file.
  std::uint64_t seed = 0;
  /// Mean over the slips of the pull, where there are more without the first and those after a hold; of
  /// contacts that scatter that of the paper.
  double mu_s = 0.0;
  double mu_k = 0.0;  ///< The same, at the speed of the belt.
  double omega_rad_per_s = 0.0;
  double gamma_over_2omega = 0.0;
  double pull_speed_m_per_s = 0.0;
  Regime regime = Regime::kUndecided;
  std::optional<double> static_coefficient;        ///< Traditional result from the noise-free force;
  std::optional<double> kinetic_coefficient;       ///< nullopt for both if the pull is too short.
  std::optional<double> oscillation_frequency_Hz;  ///< Nullopt if there is no oscillation.
  std::optional<double> amplitude;                 ///< Half the range of the first full cycle.
  base::LongColumn<ModeInterval> modes;
  base::LongColumn<TrueCycle> cycles;
  std::optional<SolverFacts> solver;  ///< Nullopt in records of versions that did not write it.
};

/// The noise-free force, scan by scan: the coefficient F/(m g) in the coupling at the true instant of
/// conversion (clock rate error and jitter included), before load cell, filter and noise. Thread-bound.
class TrueForce {
 public:
  virtual ~TrueForce() = default;

  /// Writes the coefficients of consecutive scans from `first` on; NaN where unknown, as at a scan that the
  /// source lost.
  /// \param first  not before the end of the last call.
  virtual void next(base::ScanIndex first, std::span<double> coefficient) = 0;
};

/// Thread-safe: may be asked from any thread at any time.
class TruthSource {
 public:
  virtual ~TruthSource() = default;

  /// The truth about scans [first, end), with times relative to `first`; nullopt if unknown.
  [[nodiscard]] virtual std::optional<TestTruth> truth(base::ScanIndex first, base::ScanIndex end) const = 0;

  /// The noise-free force from scan `first` on; null if unknown.
  [[nodiscard]] virtual std::unique_ptr<TrueForce> force(base::ScanIndex /*first*/) const { return nullptr; }
};

}  // namespace stickslip::model

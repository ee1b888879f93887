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

/// Interval of time spent in one mode. Seconds after the first scan of the record, by its granted scan rate.
struct ModeInterval {
  double start_s = 0.0;
  double end_s = 0.0;
  Mode mode = Mode::kStick;
};

/// True S and K of one slip that began from sticking. K is without its dependence on the speed.
struct TrueCycle {
  double onset_time_s = 0.0;  ///< Seconds after the first scan of the record, by its granted scan rate.
  double mu_s = 0.0;
  double mu_k = 0.0;
};

/// How the true motion was computed, and its accuracy.
struct SolverFacts {
  std::string method;                     ///< For people.
  double accuracy = 0.0;                  ///< Expected largest error of the coefficient.
  double accuracy_asked = 0.0;            ///< Accuracy that the scene asked for, in the same unit.
  std::optional<double> time_per_scan_s;  ///< Computing time; nullopt if not measured.

  bool operator==(const SolverFacts&) const = default;
};

struct TestTruth {
  std::string scene_name;
  std::string scene_text;  ///< Complete text of the scene file.
  std::uint64_t seed = 0;
  /// S: mean over the slips of the pull without the first and those after a rest of the belt; that of the
  /// first if there is no other. The S of the scene if there is no slip, or if S and K only scatter about it.
  double mu_s = 0.0;
  double mu_k = 0.0;  ///< K: averaged as mu_s; of sliding at the speed of the belt.
  double omega_rad_per_s = 0.0;
  double gamma_over_2omega = 0.0;
  /// At the first onset. Without a slip the scene's `constant_speed`; 0 without that, with `speed_ramp`, and
  /// without a pull.
  double pull_speed_m_per_s = 0.0;
  Regime regime = Regime::kUndecided;
  /// Traditional coefficients of the noise-free force, by the method of the test. Each is nullopt if the pull
  /// is too short for it; both without a slip.
  std::optional<double> static_coefficient;
  std::optional<double> kinetic_coefficient;
  /// Mean frequency of the onsets; with a single slip ω/2π if it rings down, else nullopt. By true time, not
  /// by the granted scan rate. Nullopt without a slip.
  std::optional<double> oscillation_frequency_Hz;
  /// Half the range of the coefficient in the first slip; nullopt without a slip.
  std::optional<double> amplitude;
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

/// Source of the truth about the scans of a board. Thread-safe: may be asked from any thread at any time.
class TruthSource {
 public:
  virtual ~TruthSource() = default;

  /// The truth about scans [first, end), with times in seconds after `first`; nullopt if unknown. Members
  /// other than modes and cycles are those of the whole run of the scene.
  [[nodiscard]] virtual std::optional<TestTruth> truth(base::ScanIndex first, base::ScanIndex end) const = 0;

  /// The noise-free force from scan `first` on; null if unknown.
  [[nodiscard]] virtual std::unique_ptr<TrueForce> force(base::ScanIndex /*first*/) const { return nullptr; }
};

}  // namespace stickslip::model

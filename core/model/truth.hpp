/// \file
/// What is known beforehand about a test, so that results can stand beside it: scenes have a
/// truth, and so do records made from scenes; a bench has none.
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

/// The sled stays in one mode from start to end; seconds after the first scan of the record.
struct ModeInterval {
  double start_s = 0.0;
  double end_s = 0.0;
  Mode mode = Mode::kStick;
};

/// S and K in force during one slip.
struct TrueCycle {
  double onset_time_s = 0.0;  ///< Seconds after the first scan of the record.
  double mu_s = 0.0;
  double mu_k = 0.0;
};

/// How the motion behind the truth was solved, and how far its numbers can be trusted.
struct SolverFacts {
  std::string method;                     ///< For people.
  double accuracy = 0.0;                  ///< In use: largest error of the coefficient to be expected.
  double accuracy_asked = 0.0;            ///< By the scene.
  std::optional<double> time_per_scan_s;  ///< Taken by the simulation; none where nobody measured it.

  bool operator==(const SolverFacts&) const = default;
};

struct TestTruth {
  std::string scene_name;
  std::string scene_text;  ///< The scene as it was read, whole.
  std::uint64_t seed = 0;
  double mu_s = 0.0;
  double mu_k = 0.0;
  double omega_rad_per_s = 0.0;
  double gamma_over_2omega = 0.0;
  double pull_speed_m_per_s = 0.0;
  Regime regime = Regime::kUndecided;
  std::optional<double> static_coefficient;        ///< What the traditional rule reads without noise,
  std::optional<double> kinetic_coefficient;       ///< from the force itself; none if the pull is too short.
  std::optional<double> oscillation_frequency_Hz;  ///< None if there is no oscillation.
  std::optional<double> amplitude;                 ///< Half the range of the first full cycle.
  base::LongColumn<ModeInterval> modes;
  base::LongColumn<TrueCycle> cycles;
  std::optional<SolverFacts> solver;  ///< None in records made before it was kept.
};

/// The noise-free force of scan after scan: the coefficient F/(m g) of the coupling itself at the instant
/// at which the converter really looked (clock rate error and jitter included), before load cell, filter
/// and all that happens to the signal. Thread-bound.
class TrueForce {
 public:
  virtual ~TrueForce() = default;

  /// The coefficients at consecutive scans from `first` on; NaN where none is known, as at a scan that the
  /// source itself lost. \param first  not before the end of the last call.
  virtual void next(base::ScanIndex first, std::span<double> coefficient) = 0;
};

/// Thread-safe: may be asked from any thread at any time.
class TruthSource {
 public:
  virtual ~TruthSource() = default;

  /// The truth about scans [first, end), with times relative to `first`; nothing if unknown.
  [[nodiscard]] virtual std::optional<TestTruth> truth(base::ScanIndex first, base::ScanIndex end) const = 0;

  /// The noise-free force from scan `first` on; null if this source does not know it.
  [[nodiscard]] virtual std::unique_ptr<TrueForce> force(base::ScanIndex /*first*/) const { return nullptr; }
};

}  // namespace stickslip::model

/// \file
/// What is known beforehand about a test, so that results can stand beside it: scenes have a
/// truth, and so do records made from scenes; a bench has none.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/scan_index.hpp"
#include "core/friction/regime.hpp"

namespace stickslip::friction {

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
  std::vector<ModeInterval> modes;
  std::vector<TrueCycle> cycles;
};

/// Thread-safe: may be asked from any thread at any time.
class TruthSource {
 public:
  virtual ~TruthSource() = default;

  /// The truth about scans [first, end), with times relative to `first`; nothing if unknown.
  [[nodiscard]] virtual std::optional<TestTruth> truth(base::ScanIndex first, base::ScanIndex end) const = 0;
};

}  // namespace stickslip::friction

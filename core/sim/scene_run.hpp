/// \file
/// One repetition of a scene as a stream of raw readings.
///
///     SceneRun run{scene, 350.0};
///     run.restart(seed);
///     std::array<double, 64> raw;
///     while (const std::size_t count = run.next(raw)) use(std::span{raw}.first(count));
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/sim/propagator.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/signal_effect.hpp"

namespace stickslip::sim {

/// Builds what the scene lists and nothing else. Needs the same memory however long the scene is.
/// Thread-bound.
class SceneRun {
 public:
  /// \param scan_rate_Hz > 0. Stands at the first scan, with the scene's own seed.
  SceneRun(const Scene& scene, double scan_rate_Hz);

  /// Back to the first scan, with these random numbers. Does not allocate.
  void restart(std::uint64_t seed);

  /// The next readings: counts if the scene lists `quantisation`, else volts. The same, however
  /// the scans are divided into calls. Does not allocate.
  /// \return how many were written; less than the size only at the end of the scene.
  std::size_t next(std::span<double> raw);

  /// How the motion is solved, and how far its numbers can be trusted; for people.
  [[nodiscard]] static std::string_view method() noexcept {
    // No steps, and event times bracketed to the last bits of a double: first_rise.hpp.
    return "exact closed forms, accurate to rounding";
  }

  /// Names of the effects that were built, in the order of the stages.
  [[nodiscard]] std::vector<std::string_view> effects() const;

 private:
  std::vector<std::string_view> motion_effects_;
  std::int64_t scan_count_;
  std::int64_t next_scan_ = 0;
  double volts_per_coefficient_;
  double zero_V_;
  Propagator motion_;
  std::vector<std::unique_ptr<SignalEffect>> signal_;
};

}  // namespace stickslip::sim

/// \file
/// One repetition of a scene as a stream of raw readings.
///
///     SceneRun run{scene, 350.0};
///     run.restart(seed);
///     std::array<double, 64> raw;
///     while (true) {
///       const std::int64_t first = run.next_scan();
///       const std::size_t count = run.next(raw);
///       if (count == 0) break;
///       use(first, std::span{raw}.first(count));
///     }
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/sim/clock_jitter.hpp"
#include "core/sim/missing_scans.hpp"
#include "core/sim/motion_solver.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/signal_effect.hpp"
#include "core/sim/transducer.hpp"

namespace stickslip::sim {

/// Simulates one repetition of a scene, reading by reading, with the effects that the scene lists. Its memory
/// is constant; where it promises not to allocate, CVODE itself still may. Thread-bound.
///
/// next() throws std::runtime_error if CVODE fails (NumericSolver), and so do restart() and the constructor
/// if the first scans are missing; then only restart() may follow.
class SceneRun {
 public:
  /// Starts at the first scan with the scene's seed, as restart() does.
  /// \param scene  need not outlive this. \param scan_rate_Hz > 0, nominal.
  SceneRun(const Scene& scene, double scan_rate_Hz);

  /// Returns to the first scan, with the random numbers of `seed`. Does not allocate.
  void restart(std::uint64_t seed);

  /// Index of the next scan that is not missing; at the end of the scene the number of scans, scan_count().
  [[nodiscard]] std::int64_t next_scan() const noexcept { return next_scan_; }

  /// The next consecutive readings, from next_scan() on: counts if the scene lists `quantisation`,
  /// else volts. The values do not depend on the division into calls. Does not allocate.
  /// \return number written: below the size of `raw` only before missing scans and at the end of the scene; 0
  /// only at the end, or for an empty `raw`.
  std::size_t next(std::span<double> raw) { return next(raw, {}); }

  /// As next(raw), and also writes the noise-free force of each reading: the coefficient F/(m g) in the
  /// coupling at the sampling instant, before transducer and signal stage. Readings are the same with and
  /// without it.
  /// \param coefficient  as long as `raw`, or empty.
  std::size_t next(std::span<double> raw, std::span<double> coefficient);

  /// Method by which the motion is solved, and its accuracy.
  [[nodiscard]] SolverMethod method() const { return motion_->method(); }

  /// Names of the effects that are simulated, in the order of the stages.
  [[nodiscard]] std::vector<std::string_view> effects() const;

 private:
  /// Simulates consecutive scans, missing ones included, so that those use their random numbers too.
  /// \param coefficient  receives the noise-free force; as many as `readings`, or none.
  void make(std::span<double> readings, std::span<double> coefficient);
  /// What the converter sees at these scans, before the signal stage, where the instants or the force
  /// between them matter.
  void look(std::span<double> readings, std::span<double> coefficient);
  void lose_missing();

  std::vector<std::string_view> other_effects_;  ///< Of the stages before the signal.
  double true_scan_rate_Hz_;
  std::int64_t scan_count_;
  std::int64_t next_scan_ = 0;
  double volts_per_coefficient_;
  double zero_V_;
  std::unique_ptr<MotionSolver> motion_;
  std::optional<Transducer> transducer_;
  std::optional<JitteringClock> jitter_;
  std::optional<MissingBursts> missing_;
  std::vector<std::unique_ptr<SignalEffect>> signal_;
};

}  // namespace stickslip::sim

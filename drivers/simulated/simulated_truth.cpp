#include "drivers/simulated/simulated_truth.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/base/long_column.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"

namespace stickslip::drivers {

void move_into_window(model::TestTruth& truth, double window_start_s, double window_length_s,
                      const std::filesystem::path& scratch_folder) {
  base::LongColumn<model::ModeInterval> modes{scratch_folder};
  for (model::ModeInterval mode : std::as_const(truth.modes)) {
    mode.start_s = std::max(mode.start_s - window_start_s, 0.0);
    mode.end_s = std::min(mode.end_s - window_start_s, window_length_s);
    if (mode.start_s < mode.end_s) modes.push_back(mode);
  }
  truth.modes = std::move(modes);
  base::LongColumn<model::TrueCycle> cycles{scratch_folder};
  for (model::TrueCycle cycle : std::as_const(truth.cycles)) {
    cycle.onset_time_s -= window_start_s;
    if (cycle.onset_time_s >= 0.0 && cycle.onset_time_s < window_length_s) cycles.push_back(cycle);
  }
  truth.cycles = std::move(cycles);
}

namespace {

/// What the force does not depend on is not built. Random streams are kept apart: the rest stays as it is.
sim::Scene force_only(sim::Scene scene) {
  scene.load_cell_dynamics.reset();
  scene.anti_alias.reset();
  scene.white_noise.reset();
  scene.drift_noise.reset();
  scene.mains_hum.reset();
  scene.spikes.reset();
  scene.quantisation.reset();
  return scene;
}

/// Plays the list again, as fast as it can.
class SimulatedForce final : public model::TrueForce {
 public:
  explicit SimulatedForce(std::shared_ptr<const Playlist> playlist) : playlist_(std::move(playlist)) {}

  void next(base::ScanIndex first, std::span<double> coefficient) override {
    std::fill(coefficient.begin(), coefficient.end(), std::numeric_limits<double>::quiet_NaN());
    const base::ScanIndex end = first + static_cast<base::ScanIndex>(coefficient.size());
    for (base::ScanIndex wanted = std::max<base::ScanIndex>(first, 0); wanted < end;) {
      if (!run_ || wanted >= playing_.end()) {
        const std::int64_t number = playlist_->repetition_of(wanted);
        if (!playlist_->has(number)) return;
        play(number);
      }
      const base::ScanIndex at = playing_.first + run_->next_scan();
      if (at >= end) return;  // What is wanted is missing.
      const base::ScanIndex until = std::min(end, playing_.end());
      const auto room = static_cast<std::size_t>(std::max<base::ScanIndex>(until - at, 0));
      const std::span<double> some = std::span{force_}.first(std::min(room, force_.size()));
      const std::size_t count = run_->next(std::span{raw_}.first(some.size()), some);
      if (count == 0) {  // The rest of this repetition is missing.
        wanted = playing_.end();
        continue;
      }
      for (std::size_t i = 0; i < count; ++i) {
        const base::ScanIndex scan = at + static_cast<base::ScanIndex>(i);
        if (scan >= first) coefficient[static_cast<std::size_t>(scan - first)] = some[i];
      }
      wanted = std::max(wanted, at + static_cast<base::ScanIndex>(count));
    }
  }

 private:
  void play(std::int64_t number) {
    playing_ = playlist_->repetition(number);
    run_.emplace(force_only(playlist_->scenes()[playing_.scene]), playlist_->scan_rate_Hz());
    run_->restart(playing_.seed);
  }

  std::shared_ptr<const Playlist> playlist_;
  Repetition playing_;
  std::optional<sim::SceneRun> run_;  ///< Of the repetition that is playing.
  std::array<double, 1024> raw_{};
  std::array<double, 1024> force_{};
};

class SimulatedTruth final : public model::TruthSource {
 public:
  SimulatedTruth(std::shared_ptr<const Playlist> playlist, model::Method method)
      : playlist_(std::move(playlist)), method_(std::move(method)) {}

  [[nodiscard]] std::optional<model::TestTruth> truth(base::ScanIndex first,
                                                      base::ScanIndex end) const override {
    first = std::max<base::ScanIndex>(first, 0);
    std::optional<Repetition> best;
    std::int64_t most = 0;
    for (std::int64_t number = playlist_->repetition_of(first); playlist_->has(number); ++number) {
      const Repetition repetition = playlist_->repetition(number);
      if (repetition.first >= end) break;
      const std::int64_t shared = std::min(end, repetition.end()) - std::max(first, repetition.first);
      if (shared > most) {
        most = shared;
        best = repetition;
      }
    }
    if (!best) return std::nullopt;
    const double rate_Hz = playlist_->scan_rate_Hz();
    try {
      model::TestTruth truth =
          sim::scene_truth(playlist_->scenes()[best->scene], rate_Hz, best->seed, method_);
      move_into_window(truth, static_cast<double>(first - best->first) / rate_Hz,
                       static_cast<double>(end - first) / rate_Hz);
      return truth;
    } catch (const std::runtime_error&) {  // The board tells that the motion cannot be solved.
      return std::nullopt;
    }
  }

  [[nodiscard]] std::unique_ptr<model::TrueForce> force(base::ScanIndex /*first*/) const override {
    return std::make_unique<SimulatedForce>(playlist_);
  }

 private:
  std::shared_ptr<const Playlist> playlist_;
  model::Method method_;
};

}  // namespace

std::shared_ptr<const model::TruthSource> make_simulated_truth(std::shared_ptr<const Playlist> playlist,
                                                               model::Method method) {
  return std::make_shared<SimulatedTruth>(std::move(playlist), std::move(method));
}

}  // namespace stickslip::drivers

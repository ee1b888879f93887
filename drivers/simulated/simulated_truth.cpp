#include "drivers/simulated/simulated_truth.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/sim/scene_truth.hpp"

namespace stickslip::drivers {

void move_into_window(friction::TestTruth& truth, double window_start_s, double window_length_s) {
  std::vector<friction::ModeInterval> modes;
  for (friction::ModeInterval mode : truth.modes) {
    mode.start_s = std::max(mode.start_s - window_start_s, 0.0);
    mode.end_s = std::min(mode.end_s - window_start_s, window_length_s);
    if (mode.start_s < mode.end_s) modes.push_back(mode);
  }
  truth.modes = std::move(modes);
  std::vector<friction::TrueCycle> cycles;
  for (friction::TrueCycle cycle : truth.cycles) {
    cycle.onset_time_s -= window_start_s;
    if (cycle.onset_time_s >= 0.0 && cycle.onset_time_s < window_length_s) cycles.push_back(cycle);
  }
  truth.cycles = std::move(cycles);
}

namespace {

class SimulatedTruth final : public friction::TruthSource {
 public:
  explicit SimulatedTruth(std::shared_ptr<const Playlist> playlist) : playlist_(std::move(playlist)) {}

  [[nodiscard]] std::optional<friction::TestTruth> truth(base::ScanIndex first,
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
    friction::TestTruth truth = sim::scene_truth(playlist_->scenes()[best->scene], rate_Hz, best->seed);
    move_into_window(truth, static_cast<double>(first - best->first) / rate_Hz,
                     static_cast<double>(end - first) / rate_Hz);
    return truth;
  }

 private:
  std::shared_ptr<const Playlist> playlist_;
};

}  // namespace

std::shared_ptr<const friction::TruthSource> make_simulated_truth(std::shared_ptr<const Playlist> playlist) {
  return std::make_shared<SimulatedTruth>(std::move(playlist));
}

}  // namespace stickslip::drivers

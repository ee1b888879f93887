#include "drivers/simulated/playlist.hpp"

#include <algorithm>
#include <utility>

#include "core/base/contract.hpp"
#include "core/sim/random_stream.hpp"

namespace stickslip::drivers {

Playlist::Playlist(std::vector<sim::Scene> scenes, int repeats, double scan_rate_Hz)
    : scenes_(std::move(scenes)), repeats_(repeats), scan_rate_Hz_(scan_rate_Hz) {
  STICKSLIP_EXPECTS(!scenes_.empty() && repeats >= 0);
  for (const sim::Scene& scene : scenes_) {
    counts_.push_back(sim::scan_count(scene, scan_rate_Hz));
    STICKSLIP_EXPECTS(counts_.back() > 0);
    round_firsts_.push_back(round_count_);
    round_count_ += counts_.back() * std::max(repeats, 1);
  }
}

bool Playlist::has(std::int64_t repetition) const noexcept {
  return repetition >= 0 &&
         (repeats_ == 0 || repetition < static_cast<std::int64_t>(scenes_.size()) * repeats_);
}

Repetition Playlist::repetition(std::int64_t number) const noexcept {
  const std::int64_t turns = std::max(repeats_, 1);
  const std::int64_t per_round = static_cast<std::int64_t>(scenes_.size()) * turns;
  const std::int64_t round = number / per_round;
  const auto scene = static_cast<std::size_t>(number % per_round / turns);
  const std::int64_t turn = number % turns;
  const base::ScanIndex first = round * round_count_ + round_firsts_[scene] + turn * counts_[scene];
  // The number among all makes even two entries of one scene differ.
  const std::uint64_t seed = sim::stream_seed(scenes_[scene].seed, static_cast<std::uint64_t>(number));
  return {number, scene, first, counts_[scene], seed};
}

std::int64_t Playlist::repetition_of(base::ScanIndex scan) const noexcept {
  const std::int64_t turns = std::max(repeats_, 1);
  const std::int64_t round = scan / round_count_;
  const std::int64_t within = scan % round_count_;
  const auto after = std::upper_bound(round_firsts_.begin(), round_firsts_.end(), within);
  const std::int64_t scene = after - round_firsts_.begin() - 1;
  const auto index = static_cast<std::size_t>(scene);
  return (round * static_cast<std::int64_t>(scenes_.size()) + scene) * turns +
         (within - round_firsts_[index]) / counts_[index];
}

}  // namespace stickslip::drivers

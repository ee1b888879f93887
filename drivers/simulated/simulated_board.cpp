#include "drivers/simulated/simulated_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/sim/belt.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"
#include "drivers/simulated/hanging_weight.hpp"
#include "drivers/simulated/playlist.hpp"
#include "drivers/simulated/scene_facts.hpp"
#include "drivers/simulated/simulated_truth.hpp"

namespace stickslip::drivers {
namespace {

using daq::ReadStatus;

class SimulatedBoard final : public daq::Board {
 public:
  SimulatedBoard(std::shared_ptr<const Playlist> playlist, base::Clock& clock,
                 const SimulatedBoardSettings& settings)
      : playlist_(std::move(playlist)),
        clock_(clock),
        continues_(settings.continues),
        info_(
            board_info_of(playlist_->scenes(), playlist_->scan_rate_Hz(), settings.speed_gain_m_per_s_per_V)),
        true_scan_rate_Hz_(sim::true_scan_rate_Hz(playlist_->scenes().front(), playlist_->scan_rate_Hz())) {
    // All runs are built here: read() may not allocate.
    for (const sim::Scene& scene : playlist_->scenes()) {
      runs_.emplace_back(scene, playlist_->scan_rate_Hz());
      belts_.push_back(sim::motion_of(scene).belt);
    }
    if (!settings.hanging.empty()) hanging_.emplace(settings.hanging, playlist_->scenes().front(), info_);
    if (!continues_) seek(settings.first_scan);
  }

  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return info_; }

  [[nodiscard]] base::Result<void> start() override {
    if (running_) return {};
    start_ns_ = clock_.monotonic_ns();
    try {
      if (const auto from = std::exchange(continues_, std::nullopt)) {
        seek(daq::first_scan_after(*from, start_ns_));
      } else if (!error_.empty()) {
        play(playing_.number + 1);  // Its motion cannot be solved any further.
      }
    } catch (const std::runtime_error& error) {
      return base::failure("{}", error_ = unsolved(error));
    }
    error_.clear();
    running_ = true;
    start_scan_ = next_;
    return {};
  }

  [[nodiscard]] ReadStatus read(daq::ScanBlock& block, std::chrono::milliseconds timeout) noexcept override {
    block.count = 0;
    const std::int64_t deadline_ns =
        clock_.monotonic_ns() + std::chrono::duration_cast<std::chrono::nanoseconds>(timeout).count();
    if (running_ && !playlist_->has(playing_.number)) return ReadStatus::kEndOfInput;
    if (!running_ || due_ns(next_) > deadline_ns) {
      clock_.sleep_until(deadline_ns);
      return ReadStatus::kTimeout;
    }
    clock_.sleep_until(due_ns(last_of_delivery(deadline_ns)));
    try {
      fill(block, clock_.monotonic_ns());
    } catch (const std::runtime_error& error) {
      running_ = false;
      error_ = unsolved(error);
      return ReadStatus::kFailed;
    }
    if (hanging_) {
      hanging_->look();
      hanging_->read(block.first, std::span{block.raw}.first(block.count));
    }
    const std::int64_t now_ns = clock_.monotonic_ns();
    const bool prompt = now_ns < due_ns(block.end() - 1) + std::llround(1e9 * kDelivery_s);
    block.stamp = {now_ns, clock_.realtime_ns(), prompt};
    return ReadStatus::kScans;
  }

  void stop() noexcept override { running_ = false; }

  [[nodiscard]] std::string last_error() const override { return error_; }

 private:
  /// As a board that interrupts when its FIFO holds so much; scan by scan the computer would do little but
  /// wake up.
  static constexpr double kDelivery_s = 0.040;

  /// The last scan that is due within a delivery of the next one, and in time.
  [[nodiscard]] base::ScanIndex last_of_delivery(std::int64_t deadline_ns) const noexcept {
    const double more =
        std::min(kDelivery_s * true_scan_rate_Hz_, static_cast<double>(daq::ScanBlock::kMaxScans - 1));
    base::ScanIndex last = std::min(next_ + static_cast<std::int64_t>(more), playing_.end() - 1);
    while (last > next_ && due_ns(last) > deadline_ns) --last;
    return last;
  }

  [[nodiscard]] std::int64_t due_ns(base::ScanIndex scan) const noexcept {
    constexpr double kNanosecondsPerSecond = 1e9;
    const auto periods = static_cast<double>(scan - start_scan_ + 1);
    return start_ns_ +
           static_cast<std::int64_t>(std::ceil(periods * kNanosecondsPerSecond / true_scan_rate_Hz_));
  }

  [[nodiscard]] std::string unsolved(const std::runtime_error& error) const {
    return fmt::format("scene {}: {}; try a gentler friction law", playlist_->scenes()[playing_.scene].name,
                       error.what());
  }

  /// Goes on with this repetition, or the first after it of which any scan arrives.
  void play(std::int64_t repetition) {
    for (;; ++repetition) {
      playing_.number = repetition;
      if (!playlist_->has(repetition)) return;
      playing_ = playlist_->repetition(repetition);
      runs_[playing_.scene].restart(playing_.seed);
      next_ = next_of_playing();
      if (next_ < playing_.end()) return;
    }
  }

  /// The next scan is this one, or the first after it that arrives.
  void seek(base::ScanIndex scan) {
    play(playlist_->repetition_of(scan));
    std::array<double, daq::ScanBlock::kMaxScans> passed{};
    while (next_ < scan && playlist_->has(playing_.number)) {
      const auto left = static_cast<std::size_t>(scan - next_);
      runs_[playing_.scene].next(std::span{passed}.first(std::min(left, passed.size())));
      next_ = next_of_playing();
      if (next_ == playing_.end()) play(playing_.number + 1);
    }
  }

  [[nodiscard]] base::ScanIndex next_of_playing() const noexcept {
    return playing_.first + runs_[playing_.scene].next_scan();
  }

  /// All scans that are due, at least the next one, as many as fit, follow each other without a jump
  /// and belong to the list.
  void fill(daq::ScanBlock& block, std::int64_t now_ns) {
    block.first = next_;
    std::size_t wanted = 1;
    while (wanted < daq::ScanBlock::kMaxScans &&
           due_ns(next_ + static_cast<std::int64_t>(wanted)) <= now_ns) {
      ++wanted;
    }
    block.has_second = info_.second.has_value();
    std::size_t count = 0;
    while (count < wanted && next_ == block.first + static_cast<std::int64_t>(count) &&
           playlist_->has(playing_.number)) {
      const std::size_t more =
          runs_[playing_.scene].next(std::span{block.raw}.subspan(count, wanted - count));
      if (block.has_second) read_speed(next_, std::span{block.second}.subspan(count, more));
      count += more;
      next_ = next_of_playing();
      if (next_ == playing_.end()) play(playing_.number + 1);
    }
    block.count = static_cast<std::uint32_t>(count);
  }

  /// Of scans of the repetition that is playing.
  void read_speed(base::ScanIndex first, std::span<std::int32_t> codes) const noexcept {
    const daq::SecondChannel& channel = *info_.second;
    const auto maxdata = static_cast<double>(channel.maxdata);
    const double codes_per_V = maxdata / (channel.range_max_V - channel.range_min_V);
    for (std::int32_t& code : codes) {
      const double time_s = static_cast<double>(first++ - playing_.first) / true_scan_rate_Hz_;
      const double volts = sim::belt_speed_m_per_s(belts_[playing_.scene], time_s) / channel.gain_per_V;
      code = static_cast<std::int32_t>(
          std::clamp(std::round((volts - channel.range_min_V) * codes_per_V), 0.0, maxdata));
    }
  }

  std::shared_ptr<const Playlist> playlist_;
  base::Clock& clock_;
  std::optional<daq::Continuation> continues_;  ///< Until the first start.
  daq::BoardInfo info_;
  double true_scan_rate_Hz_;         ///< Rate at which scans fall due; not reported.
  std::vector<sim::SceneRun> runs_;  ///< One for each scene.
  std::vector<std::vector<sim::BeltSegment>> belts_;
  std::optional<HangingWeight> hanging_;
  Repetition playing_;
  base::ScanIndex next_ = 0;
  bool running_ = false;
  std::string error_;  ///< Since the last start that succeeded.
  base::ScanIndex start_scan_ = 0;
  std::int64_t start_ns_ = 0;
};

/// What one calibration and one tester of the program must hold for.
base::Result<void> agree(const sim::Scene& scene, const sim::Scene& first, bool rate_is_given) {
  const auto differs = [&](const char* what) {
    return base::usage_error(
        "scene {}: {} differs from that of scene {}; scenes that are played together need the same",
        scene.name, what, first.name);
  };
  if (scene.sled_mass_kg != first.sled_mass_kg) return differs("sled_mass");
  if (scene.gravity_m_per_s2 != first.gravity_m_per_s2) return differs("gravity");
  if (scene.load_cell.gain_N_per_V != first.load_cell.gain_N_per_V) return differs("load_cell_gain");
  if (scene.load_cell.zero_V != first.load_cell.zero_V) return differs("load_cell_zero");
  if (scene.quantisation != first.quantisation) return differs("quantisation");
  if (scene.clock_rate_error != first.clock_rate_error) return differs("clock_rate_error");
  if (!rate_is_given && scene.scan_rate_Hz != first.scan_rate_Hz) return differs("scan_rate");
  return {};
}

}  // namespace

base::Result<SimulatedTester> make_simulated_tester(const SimulatedBoardSettings& settings,
                                                    base::Clock& clock) {
  if (settings.scenes.empty()) {
    return base::usage_error("the simulated board has no scenes; name at least one scene file");
  }
  if (settings.repeats < 0) {
    return base::usage_error("repeats = {} of the simulated board must be 0 (for ever) or more",
                             settings.repeats);
  }
  if (settings.first_scan < 0) {
    return base::usage_error("first scan {} of the simulated board must be 0 or more", settings.first_scan);
  }
  std::vector<sim::Scene> scenes;
  for (const std::filesystem::path& file : settings.scenes) {
    base::Result<sim::Scene> scene = sim::load_scene(file);
    if (!scene) return tl::unexpected(scene.error());
    scenes.push_back(std::move(*scene));
    if (auto same = agree(scenes.back(), scenes.front(), settings.scan_rate_Hz.has_value()); !same) {
      return tl::unexpected(same.error());
    }
  }
  const double rate_Hz = settings.scan_rate_Hz.value_or(scenes.front().scan_rate_Hz);
  if (!(rate_Hz > 0.0) || !std::isfinite(rate_Hz)) {
    return base::usage_error("scan rate {} Hz of the simulated board must be above 0", rate_Hz);
  }
  for (const sim::Scene& scene : scenes) {
    if (sim::scan_count(scene, rate_Hz) < 1) {
      return base::usage_error("scene {}: lasts {} s, shorter than one scan at {} Hz", scene.name,
                               scene.duration_s, rate_Hz);
    }
  }
  if (settings.speed_gain_m_per_s_per_V && !scenes.front().quantisation) {
    return base::usage_error(
        "scene {}: lists no quantisation; a speed channel reads through a converter like that of the force",
        scenes.front().name);
  }
  SimulatedTester result;
  result.load_cell = load_cell_of(scenes.front());
  result.tester = tester_of(scenes);
  auto playlist = std::make_shared<const Playlist>(std::move(scenes), settings.repeats, rate_Hz);
  result.truth = make_simulated_truth(playlist, settings.method);
  try {
    result.board = std::make_unique<SimulatedBoard>(std::move(playlist), clock, settings);
  } catch (const std::runtime_error& error) {
    return base::failure("simulated board, scans before {}: {}; try a gentler friction law",
                         settings.first_scan, error.what());
  }
  if (settings.faults.overruns_every_s > 0.0 || settings.faults.losses_every_s > 0.0)
    result.board = with_faults(std::move(result.board), settings.faults);
  return result;
}

}  // namespace stickslip::drivers

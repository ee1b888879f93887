/// \file
/// Makes the frames of the live stream, in JSON: minimum and maximum of the force in each interval, cycles,
/// tests, gaps, states of the bench. docs/control.md describes the frames.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/clock.hpp"
#include "core/pipeline/sink.hpp"

namespace stickslip::live {

/// A sink; its functions run on the processing thread. Without listeners it makes no frames.
class LiveFeed final : public pipeline::Sink {
 public:
  /// \param clock    clock of the board; outlives the feed.
  /// \param publish  called on the processing thread with each frame; must not block.
  LiveFeed(const base::Clock& clock, std::function<void(std::string)> publish)
      : clock_(clock), publish_(std::move(publish)) {}

  /// Sets the number of listeners. Any thread.
  void listeners(std::size_t count) noexcept { listeners_.store(count, std::memory_order_relaxed); }
  /// Call it before each session. \param clock_speed  board time over wall time.
  void use(double scan_rate_Hz, double clock_speed);

  void observed(daq::ScanIndex first, std::span<const double> coefficient,
                const detect::LiveState& live) override;
  void test_began(const pipeline::TestStart& start) override;
  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second,
             const daq::ClockStamp& stamp) override;
  void fall(const detect::FallBegun& fall) override;
  void cycle(const detect::Cycle& cycle) override;
  void gap(const daq::Gap& gap) override { tell_gap(gap); }
  void gap_between_tests(const daq::Gap& gap) override { tell_gap(gap); }
  void note(const daq::Note& note) override;
  void note_between_tests(const daq::Note& one) override { note(one); }
  void test_ended(const pipeline::TestEnd& end) override;
  void bench_changed(pipeline::BenchState state) override;
  void bench_stays(pipeline::BenchState state, double duration_s, pipeline::BenchTrouble trouble) override;

 private:
  [[nodiscard]] bool heard() const noexcept { return listeners_.load(std::memory_order_relaxed) > 0; }
  void tell_gap(const daq::Gap& gap);
  void flush(const detect::LiveState& live);
  /// Time of the read of the running test's latest block, s since 1970.
  [[nodiscard]] double read_time_s() const noexcept;
  /// Present time, s since 1970.
  [[nodiscard]] double sink_time_s() const;

  const base::Clock& clock_;
  std::function<void(std::string)> publish_;
  std::atomic<std::size_t> listeners_{0};
  double scan_rate_Hz_ = 0.0;
  double clock_speed_ = 1.0;
  std::size_t bucket_ = 1;       ///< Scans in one part, which is drawn as minimum and maximum.
  std::size_t frame_parts_ = 1;  ///< Parts in one frame.
  std::int64_t test_ = 0;
  daq::ScanIndex test_first_ = 0;
  std::int64_t read_realtime_ns_ = 0;  ///< Of the latest block of the running test.

  // The next frame.
  daq::ScanIndex first_ = 0;
  daq::ScanIndex next_ = 0;
  std::size_t in_part_ = 0;
  std::vector<double> lowest_;
  std::vector<double> highest_;
};

}  // namespace stickslip::live

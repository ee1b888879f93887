#include "daemon/live/feed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/or_null.hpp"
#include "io/results_json.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"

namespace stickslip::live {
namespace {

using Json = nlohmann::ordered_json;

/// Frames per second of wall time: enough for smooth motion.
constexpr double kFrames_Hz = 20.0;
/// Parts per second of wall time: a window of 10 s has two for each of 2000 pixels.
constexpr double kParts_Hz = 400.0;
/// Most spikes in the frame of a test's end; the record has all.
constexpr std::size_t kMostSpikes = 1000;
constexpr double kNanosecond_s = 1e-9;

/// Appends coefficients with six decimals, a tenth of the finest step of a 16-bit board.
void append(std::string& text, const std::vector<double>& values) {
  for (const double value : values) {
    if (text.back() != '[') text += ',';
    text += std::isfinite(value) ? fmt::format("{:.6f}", value) : "null";
  }
}

}  // namespace

void LiveFeed::use(double scan_rate_Hz, double clock_speed) {
  scan_rate_Hz_ = scan_rate_Hz;
  clock_speed_ = clock_speed;
  const double wall_Hz = scan_rate_Hz * clock_speed;
  bucket_ = static_cast<std::size_t>(std::max(1.0, std::ceil(wall_Hz / kParts_Hz)));
  frame_parts_ = static_cast<std::size_t>(
      std::max(1.0, std::round(wall_Hz / kFrames_Hz / static_cast<double>(bucket_))));
  lowest_.clear();
  highest_.clear();
  in_part_ = 0;
}

void LiveFeed::observed(daq::ScanIndex first, std::span<const double> coefficient,
                        const detect::LiveState& live) {
  if (!heard()) {
    lowest_.clear();
    highest_.clear();
    return;
  }
  if (first != next_) flush(live);
  next_ = first + static_cast<daq::ScanIndex>(coefficient.size());
  for (const double value : coefficient) {
    if (lowest_.empty()) {
      first_ = first;
      in_part_ = 0;
    }
    ++first;
    if (in_part_ == 0) {
      lowest_.push_back(value);
      highest_.push_back(value);
    } else {
      lowest_.back() = std::min(lowest_.back(), value);
      highest_.back() = std::max(highest_.back(), value);
    }
    in_part_ = (in_part_ + 1) % bucket_;
    if (in_part_ == 0 && lowest_.size() >= frame_parts_) flush(live);
  }
}

void LiveFeed::flush(const detect::LiveState& live) {
  if (lowest_.empty()) return;
  std::string frame = fmt::format(
      R"({{"type":"scans","first_scan":{},"scans_in_part":{},"scan_rate":{},"clock_speed":{},"test":{},"read_time":{},"sink_time":{},"phase":"{}","regime":"{}","slip_count":{},"lowest":[)",
      first_, bucket_, scan_rate_Hz_, clock_speed_, test_ == 0 ? "null" : std::to_string(test_),
      test_ == 0 ? "null" : fmt::format("{:.6f}", read_time_s()),
      test_ == 0 ? "null" : fmt::format("{:.6f}", sink_time_s()), detect::name(live.phase),
      model::name(live.regime), live.slip_count);
  append(frame, lowest_);
  frame += R"(],"highest":[)";
  append(frame, highest_);
  frame += "]}";
  lowest_.clear();
  highest_.clear();
  publish_(std::move(frame));
}

void LiveFeed::test_began(const pipeline::TestStart& start) {
  test_ = start.number;
  test_first_ = start.first;
  if (!heard()) return;
  publish_(Json{{"type", "test-began"},
                {"test", start.number},
                {"first_scan", start.first},
                {"trigger_scan", start.trigger},
                {"by_command", start.by_command}}
               .dump());
}

void LiveFeed::scans(daq::ScanIndex /*first*/, std::span<const double> /*raw*/,
                     std::span<const std::int32_t> /*second*/, const daq::ClockStamp& stamp) {
  read_realtime_ns_ = stamp.realtime_ns;
}

double LiveFeed::read_time_s() const noexcept {
  return static_cast<double>(read_realtime_ns_) * kNanosecond_s;
}

double LiveFeed::sink_time_s() const { return static_cast<double>(clock_.realtime_ns()) * kNanosecond_s; }

void LiveFeed::fall(const detect::FallBegun& fall) {
  if (!heard()) return;
  publish_(Json{{"type", "fall"},
                {"test", test_},
                {"scan_rate", scan_rate_Hz_},
                {"read_time", read_time_s()},
                {"sink_time", sink_time_s()},
                {"peak_scan", fall.peak_scan},
                {"peak", fall.peak},
                {"seen_scan", fall.seen_scan}}
               .dump());
}

void LiveFeed::cycle(const detect::Cycle& cycle) {
  if (!heard()) return;
  publish_(Json{{"type", "cycle"},
                {"test", test_},
                {"test_first_scan", test_first_},
                {"scan_rate", scan_rate_Hz_},
                {"read_time", read_time_s()},
                {"sink_time", sink_time_s()},
                {"number", cycle.number},
                {"first_scan", cycle.first_scan},
                {"captured", (cycle.flags & detect::kCycleCaptured) != 0},
                {"onset_time", io::or_null(cycle.onset_time_s)},
                {"capture_time", io::or_null(cycle.capture_time_s)},
                {"peak_time", io::or_null(cycle.peak_time_s)},
                {"period", io::or_null(cycle.period_s)},
                {"peak", io::or_null(cycle.peak)},
                {"trough", io::or_null(cycle.trough)},
                {"force_drop", io::or_null(cycle.force_drop)},
                {"delta_mu", io::or_null(cycle.delta_mu)},
                {"delta_mu_standard_error", io::or_null(cycle.delta_mu_standard_error)},
                {"slip_speed_ratio", io::or_null(cycle.slip_speed_ratio)}}
               .dump());
}

void LiveFeed::tell_gap(const daq::Gap& gap) {
  if (!heard()) return;
  publish_(Json{
      {"type", "gap"}, {"first_scan", gap.first}, {"scan_count", gap.count}, {"cause", daq::name(gap.cause)}}
               .dump());
}

void LiveFeed::note(const daq::Note& note) {
  if (!heard()) return;
  publish_(Json{{"type", "note"}, {"scan", note.scan}, {"text", base::printable(daq::to_text(note))}}.dump());
}

void LiveFeed::test_ended(const pipeline::TestEnd& end) {
  test_ = 0;
  if (!heard()) return;
  const std::size_t told =
      std::min(end.spikes.size(), kMostSpikes);  // The last: a scope may still show them.
  publish_(Json{{"type", "test-ended"},
                {"test", end.number},
                {"scan_rate", scan_rate_Hz_},
                {"first_scan", test_first_},
                {"end_scan", end.end},
                {"cause", pipeline::name(end.cause)},
                {"spikes", std::span{end.spikes}.last(told)},
                {"spike_coefficients", std::span{end.spike_coefficients}.last(told)},
                {"results", io::results_json(end.results, false)}}
               .dump());
}

void LiveFeed::bench_changed(pipeline::BenchState state) {
  if (heard()) publish_(Json{{"type", "bench"}, {"bench", pipeline::name(state)}}.dump());
}

void LiveFeed::bench_stays(pipeline::BenchState state, double /*duration_s*/,
                           pipeline::BenchTrouble trouble) {
  if (!heard()) return;
  publish_(Json{{"type", "bench"}, {"bench", pipeline::name(state)}, {"trouble", pipeline::words(trouble)}}
               .dump());
}

}  // namespace stickslip::live

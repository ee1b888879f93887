#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "core/pipeline/processor.hpp"
#include "tests/support/live_trials.hpp"

namespace stickslip::pipeline {
namespace {

/// What the live side said, as bits: NaN equals NaN.
class Listener final : public Sink {
 public:
  void fall(const detect::FallBegun& fall) override {
    falls.push_back(static_cast<std::uint64_t>(fall.peak_scan));
    falls.push_back(static_cast<std::uint64_t>(fall.seen_scan));
    falls.push_back(std::bit_cast<std::uint64_t>(fall.peak));
  }
  void cycle(const detect::Cycle& cycle) override {
    bits.push_back(static_cast<std::uint64_t>(cycle.number));
    bits.push_back(static_cast<std::uint64_t>(cycle.first_scan));
    bits.push_back(cycle.flags);
    for (const double value :
         {cycle.onset_time_s, cycle.capture_time_s, cycle.peak_time_s, cycle.period_s, cycle.stick_time_s,
          cycle.slip_time_s, cycle.peak, cycle.trough, cycle.force_drop, cycle.delta_mu,
          cycle.delta_mu_standard_error, cycle.slip_speed_ratio}) {
      bits.push_back(std::bit_cast<std::uint64_t>(value));
    }
  }
  std::vector<std::uint64_t> bits;
  std::vector<std::uint64_t> falls;  ///< Apart: between blocks falls are told before cycles.
};

constexpr daq::ScanIndex kLostFrom = 250;

/// One gap at the same scan, if there is any.
std::vector<std::uint64_t> live_bits(const std::vector<double>& scans, const ProcessorSettings& settings,
                                     const std::vector<std::size_t>& sizes, daq::ScanIndex lost) {
  daq::BoardInfo board;
  board.quantity = daq::RawQuantity::kCoefficient;
  Listener listener;
  Processor processor{settings, {board, {}, 1.0}, {&listener}};
  std::size_t size = 0;
  for (std::size_t k = 0; k < scans.size();) {
    daq::ScanBlock block;
    block.first = static_cast<daq::ScanIndex>(k) + (k >= kLostFrom ? lost : 0);
    const std::size_t most = sizes[size++ % sizes.size()];
    while (k < scans.size() && block.count < most && !(block.count > 0 && k == kLostFrom)) {
      block.raw[block.count++] = scans[k++];
    }
    processor.process(block, daq::GapCause::kRingFull);
  }
  processor.finish(EndCause::kEndOfInput);
  listener.bits.insert(listener.bits.end(), listener.falls.begin(), listener.falls.end());
  return listener.bits;
}

/// Any regime, with spikes.
std::vector<double> any_scans(test::LiveScene& scene) {
  scene.Q = 0.01 * *rc::gen::inRange(20, 190);
  scene.slips = *rc::gen::inRange(0, 6);
  scene.escape_Q = scene.slips == 0 || *rc::gen::arbitrary<bool>() ? 3.0 : 0.0;
  scene.sigma = 1e-4 * *rc::gen::inRange(1, 40);
  scene.scatter = 0.1 * *rc::gen::inRange(0, 4);
  scene.seed = *rc::gen::arbitrary<std::uint32_t>();
  test::LiveTrial trial{scene};
  std::vector<double> scans;
  while (static_cast<std::int64_t>(scans.size()) < trial.scan_count()) scans.push_back(trial.next());
  for (int spikes = *rc::gen::inRange(0, 3); spikes > 0; --spikes) {
    scans[*rc::gen::inRange<std::size_t>(0, scans.size())] += 0.3;
  }
  return scans;
}

RC_GTEST_PROP(LiveProperty, BlocksDoNotMatter, ()) {
  test::LiveScene scene;
  const std::vector<double> scans = any_scans(scene);
  ProcessorSettings settings;
  settings.segmenter.scan_rate_Hz = settings.analysis.scan_rate_Hz = scene.scan_rate_Hz;
  settings.analysis.estimator =
      *rc::gen::element(detect::EstimatorTier::kTurningPoints, detect::EstimatorTier::kFit);
  const auto sizes = *rc::gen::nonEmpty(rc::gen::container<std::vector<std::size_t>>(
      rc::gen::inRange<std::size_t>(1, daq::ScanBlock{}.raw.size() + 1)));
  const daq::ScanIndex lost = *rc::gen::element<daq::ScanIndex>(0, 1, 40);
  const auto whole = live_bits(scans, settings, {daq::ScanBlock{}.raw.size()}, lost);
  RC_ASSERT(live_bits(scans, settings, sizes, lost) == whole);
  RC_TAG(whole.empty());
}

// Whatever comes in, phases follow one another, and numbers are numbers or NaN with their sizes positive.
RC_GTEST_PROP(LiveProperty, AnySignalIsFollowed, ()) {
  detect::LiveSettings settings;
  settings.estimator = *rc::gen::element(detect::EstimatorTier::kTurningPoints, detect::EstimatorTier::kFit);
  detect::LiveDetector detector{settings};
  const int period = *rc::gen::inRange(2, 60);
  const double scale = std::pow(10.0, *rc::gen::inRange(-6, 7));
  const int shape = *rc::gen::inRange(0, 5);
  std::mt19937_64 engine{*rc::gen::arbitrary<std::uint32_t>()};
  std::normal_distribution<double> normal;
  double walk = 0.0;
  detect::Phase phase = detector.state().phase;
  const auto check = [&](const std::optional<detect::LiveCycle>& closed) {
    if (!closed) return;
    const detect::Cycle& cycle = closed->cycle;
    for (const double size : {cycle.delta_mu_standard_error, cycle.slip_time_s, cycle.period_s}) {
      RC_ASSERT(std::isnan(size) || (std::isfinite(size) && size >= 0.0));
    }
    RC_ASSERT(std::isfinite(cycle.peak) && std::isfinite(cycle.force_drop));
    RC_ASSERT(!std::isinf(cycle.delta_mu) && !std::isinf(cycle.onset_time_s));
  };
  for (int k = 0; k < 1500; ++k) {
    walk += normal(engine);
    const double saw = static_cast<double>(k % period) / period;
    const std::array<double, 5> values{saw, walk, saw < 0.5 ? 1.0 : 0.0, std::sin(6.283 * saw) + 0.01 * walk,
                                       normal(engine)};
    if (engine() % 1000 == 0) detector.gap(1 + static_cast<std::int64_t>(engine() % 50));
    check(detector.add(scale * values[static_cast<std::size_t>(shape)], engine() % 500 == 0));
    const detect::Phase now = detector.state().phase;
    // A first fall that was no slip is loading still.
    RC_ASSERT(now >= phase || (phase == detect::Phase::kFirstSlip && now == detect::Phase::kLoading));
    phase = now;
  }
  check(detector.end());
}

}  // namespace
}  // namespace stickslip::pipeline

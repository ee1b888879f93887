/// \file
/// The way of a scan through the instrument without its threads and files: board, calibration,
/// segmenter, analysis.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "core/daq/calibration.hpp"
#include "core/model/truth.hpp"
#include "core/pipeline/segmenter.hpp"
#include "drivers/simulated/simulated_board.hpp"
#include "tests/support/manual_clock.hpp"

namespace stickslip::test {

struct AnalysedTest {
  base::ScanIndex first = 0;    ///< First scan of the record.
  base::ScanIndex trigger = 0;  ///< Scan at which the segmenter said that it starts.
  base::ScanIndex end = 0;
  pipeline::Segmenter::Event ended_by = pipeline::Segmenter::Event::kNone;  ///< kNone: the input ended.
  analysis::TestResults results;
  base::LongColumn<detect::Cycle> cycles;
  std::optional<model::TestTruth> truth;
};

/// Plays the scene so many times and analyses every test that the segmenter finds.
/// \param speed_gain_m_per_s_per_V  of a speed channel, which then takes the place of the plan; absent: the
/// plan
///        is known.
/// \param prior  of the tester's parameters.
inline std::vector<AnalysedTest> analyse_scene(const std::filesystem::path& scene, int repeats,
                                               std::optional<double> speed_gain_m_per_s_per_V = {},
                                               const estimate::SharedPrior& prior = {}) {
  using Event = pipeline::Segmenter::Event;
  ManualClock clock;
  auto tester = drivers::make_simulated_tester({.scenes = {scene},
                                                .repeats = repeats,
                                                .scan_rate_Hz = {},
                                                .method = {},
                                                .speed_gain_m_per_s_per_V = speed_gain_m_per_s_per_V},
                                               clock);
  if (!tester) throw std::runtime_error(tester.error().message);
  daq::Board& board = *tester->board;
  const daq::Calibration calibration{board.info(), tester->load_cell, tester->tester.normal_load_N()};
  analysis::AnalysisSettings analysis_settings;
  analysis_settings.scan_rate_Hz = board.info().scan_rate_granted_Hz;
  analysis_settings.step_coefficient = calibration.step_coefficient();
  analysis_settings.tester = tester->tester;
  analysis_settings.prior = prior;
  const std::optional<daq::SecondChannel> channel = board.info().second;
  if (channel) {
    analysis_settings.tester.speed_course.reset();
    analysis_settings.speed_step_m_per_s = channel->step();
  }
  pipeline::SegmenterSettings segmenter_settings;
  segmenter_settings.scan_rate_Hz = analysis_settings.scan_rate_Hz;
  segmenter_settings.step_coefficient = analysis_settings.step_coefficient;
  pipeline::Segmenter segmenter{segmenter_settings};

  std::vector<AnalysedTest> tests;
  std::unique_ptr<analysis::TestAnalysis> analysis;
  AnalysedTest test;
  struct Scan {
    double raw;
    std::int32_t speed;
  };
  std::deque<Scan> before;  // from before the trigger
  const auto add = [&](base::ScanIndex index, double raw, std::int32_t speed) {
    if (channel) analysis->speed(channel->value(speed));
    analysis->add(index, calibration.coefficient(raw), calibration.saturated(raw));
  };
  const auto finish = [&](base::ScanIndex end, Event event) {
    test.end = end;
    test.ended_by = event;
    test.results = analysis->finish();
    test.cycles = analysis->cycles();
    test.truth = tester->truth->truth(test.first, test.end);
    tests.push_back(std::move(test));
    analysis.reset();
  };
  const auto take = [&](base::ScanIndex index, double raw, std::int32_t speed) {
    const Event event = segmenter.observe(index, calibration.coefficient(raw));
    if (analysis) {
      add(index, raw, speed);
      if (event == Event::kUnloaded || event == Event::kNoRelativeMotion) finish(index + 1, event);
      return;
    }
    before.push_back({raw, speed});
    if (event == Event::kTestStarts) {
      analysis = std::make_unique<analysis::TestAnalysis>(analysis_settings);
      test = {};
      test.trigger = index;
      test.first = index + 1 - static_cast<base::ScanIndex>(before.size());
      for (std::size_t k = 0; k < before.size(); ++k) {
        add(test.first + static_cast<base::ScanIndex>(k), before[k].raw, before[k].speed);
      }
      before.clear();
    } else if (before.size() > segmenter_settings.pre_trigger_scans()) {
      before.pop_front();
    }
  };

  if (!board.start()) throw std::runtime_error(board.last_error());
  daq::ScanBlock block;
  base::ScanIndex end = 0;
  while (true) {
    const daq::ReadStatus status = board.read(block, std::chrono::milliseconds{1000});
    if (status == daq::ReadStatus::kTimeout) continue;
    if (status != daq::ReadStatus::kScans) break;
    for (std::uint32_t k = 0; k < block.count; ++k) {
      take(block.first + static_cast<base::ScanIndex>(k), block.raw[k], block.second[k]);
    }
    end = block.end();
  }
  if (analysis) finish(end, Event::kNone);
  return tests;
}

}  // namespace stickslip::test

/// \file
/// Tests on the whole path of a scan, for control charts: scene, simulated board, calibration, segmenter,
/// self-check, analysis, and what the daemon's history takes from them.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "core/pipeline/processor.hpp"
#include "daemon/types/tester_history.hpp"
#include "drivers/simulated/simulated_board.hpp"
#include "tests/support/manual_clock.hpp"

namespace stickslip::test {

/// The values that the tests of a scene, played so many times, give to the charts; their sample is
/// "reference".
inline std::vector<trend::TestValues> tests_of_scene(const std::filesystem::path& scene, int repeats) {
  struct Collector final : pipeline::Sink {
    record::Record record;
    std::vector<trend::TestValues> tests;
    daq::ScanIndex trigger = 0;

    void test_began(const pipeline::TestStart& start) override {
      record.header.self_check =
          start.self_check ? std::optional<daq::SelfCheck>{*start.self_check} : std::nullopt;
      record.header.trigger_scan = start.trigger;
    }
    void test_ended(const pipeline::TestEnd& end) override {
      record.end = record::EndRecord{};
      record.end->results = end.results;
      record.end->end_realtime_ns = record::realtime_at(record.header, end.end);
      const auto event = daemon::test_event(record, std::to_string(end.number) + ".h5");
      tests.push_back(std::get<daemon::TestFinished>(event->what).values);
    }
  };
  ManualClock clock;
  auto tester =
      drivers::make_simulated_tester({.scenes = {scene}, .repeats = repeats, .scan_rate_Hz = {}}, clock);
  if (!tester) throw std::runtime_error(tester.error().message);
  daq::Board& board = *tester->board;
  if (!board.start()) throw std::runtime_error(board.last_error());
  pipeline::ProcessorSettings settings;
  settings.analysis.scan_rate_Hz = board.info().scan_rate_granted_Hz;
  settings.analysis.tester = tester->tester;
  settings.segmenter.scan_rate_Hz = settings.analysis.scan_rate_Hz;
  settings.clock_is_real = false;
  Collector collector;
  collector.record.header.board = board.info();
  collector.record.header.sample.name = "reference";
  collector.record.header.start_realtime_ns = 0;
  pipeline::Processor processor{
      settings,
      daq::Calibration{board.info(), tester->load_cell, tester->tester.normal_load_N()},
      {&collector}};
  daq::ScanBlock block;
  while (true) {
    const daq::ReadStatus status = board.read(block, std::chrono::milliseconds{1000});
    if (status == daq::ReadStatus::kTimeout) continue;
    if (status != daq::ReadStatus::kScans) break;
    processor.process(block, daq::GapCause::kUnknown);
  }
  processor.finish(pipeline::EndCause::kEndOfInput);
  return std::move(collector.tests);
}

}  // namespace stickslip::test

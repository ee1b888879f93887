/// \file
/// Records with every field set to something of its own, and a folder that goes away.
#pragma once

#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "core/record/record.hpp"

namespace stickslip::test {

/// A new folder under the system's temporary one, removed with all its content at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "stickslip-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string content_of(const std::filesystem::path& path) {
  std::ifstream file{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, {}};
}

inline void write_content(const std::filesystem::path& path, const std::string& content) {
  std::ofstream{path, std::ios::binary} << content;
}

inline record::RecordHeader sample_header() {
  record::RecordHeader header;
  header.uuid = "0f8fad5b-d9cb-469f-a165-70867728950e";
  header.title = "grade A, machine direction, µ";
  header.test_number = 7;
  header.trigger_scan = 1005;
  header.start_realtime_ns = 1'795'265'582'123'456'789;
  header.board.driver = "simulated";
  header.board.board_name = "das1602/16";
  header.board.device = "/dev/comedi0";
  header.board.subdevice = 1;
  header.board.channel = 3;
  header.board.maxdata = 65535;
  header.board.range_min_V = -5.0;
  header.board.range_max_V = 5.0;
  header.board.polynomial = {-5.0, 10.0 / 65535.0, 1e-12};
  header.board.expansion_origin = 2.0;
  header.board.calibration = "soft";
  header.board.acquisition = "command";
  header.board.scan_rate_requested_Hz = 350.0;
  header.board.scan_rate_granted_Hz = 350.0000350000035;
  header.board.second = daq::SecondChannel{daq::SecondQuantity::kPullSpeed, 4,   4095,   -2.5,   2.5,
                                           {-2.5, 5.0 / 4095.0, 1e-9},      1.0, "hard", 0.0021, 0.05};
  header.load_cell = daq::LoadCell{9.8, 0.01};
  header.calibration = {"2026-05-01",
                        "DKD-1234",
                        0.003,
                        2e-5,
                        4e-5,
                        -1e-5,
                        "2027-05-01",
                        5.0,
                        {0.0, 1.0, 2.0},
                        {0.0, 9.81, 19.62},
                        {0.01, 1.011, 2.012},
                        {1e-5, 2e-5, 3e-5},
                        {0.0, 1e-6, -2e-6},
                        {"", "", "unsteady"}};
  header.tester = {2.331, 9.81, 0.00508, 4200.0, "0:0.00508 2.5:0.0101", 120.0, 0.04, 60.0, 3};
  header.sample = {"linerboard 42", "kraft", "MD", "wire", 3, 2, "20261122T180301Z", "Ada", {}};
  header.process = {"stickslipd",
                    "0.1.0",
                    "8a83624",
                    "[tester]\nsled_mass = \"2331 g\"\n",
                    "closed form",
                    "TAPPI T 816",
                    "spikes,first-slip",
                    "[tester]\nomega = \"125.7 rad/s\"\n",
                    "SCHED_FIFO 20",
                    "exact closed forms",
                    "trace.csv",
                    43'566,
                    "0f",
                    "recognised: UTF-8",
                    "stickslip import trace.csv"};
  header.sample.metadata = {{"contact_time", "15 s"},
                            {"humidity", "52 %"},
                            {"room.temperature", "23.1 °C = ok"},
                            {"temperature", "23.1 degC"}};
  header.plan = {0.05, 0.01, 0.25, 0.02, 0.25, 0.5, 0.0031};
  daq::SelfCheck& check = header.self_check.emplace();
  check = {990, {2000.0, 2001.0, 1999.0}, 0.02, 1e-3, -2e-4, 3e-4, 0.005, 1e-4, 2e-4, 5e-5, 1, 2, 350.1, 0.02,
           {}};
  check.findings = {"hum of 0.0001 N at 50 Hz", "grün"};
  return header;
}

inline analysis::TestResults sample_results() {
  analysis::TestResults results;
  results.regime = model::Regime::kMixed;
  results.regime_reason = "3 of 5 slips captured";
  results.rung = analysis::Rung::kTwoParameterLaw;
  results.rung_reason = "the slope of K is not significant";
  results.misfit_place = "peak";
  results.findings = {
      base::make_finding(base::FindingCode::kPullSpeed,
                         "the pull speed was 6.00 +- 0.02 in/min, the plan says 12.00",
                         {{"pull_speed_measured", 0.00254, "m/s"}, {"pull_speed", 0.00508, "m/s"}}),
      base::make_finding(base::FindingCode::kUncoded, "another")};
  double number = 0.1;
  analysis::for_each_result(results, [&](const analysis::ResultName& name, analysis::Estimate& estimate) {
    if (name.name == "Q_threshold") {
      estimate = analysis::Estimate::none("damping not known");
      return;
    }
    number += 0.1;
    estimate = analysis::Estimate::of(number, number / 3.0);
    if (name.name == "mu_s") {
      add_systematic(estimate, {{analysis::UncertaintySource::kRung, 0.0005},
                                {analysis::UncertaintySource::kMisfit, 0.0015}});
      note_no_systematic(estimate, analysis::UncertaintySource::kZero);
    }
    if (name.name == "cycle_count") estimate.standard_error.reset();
  });
  return results;
}

inline std::vector<detect::Cycle> sample_cycles() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  detect::Cycle first{0,    1010,  0.1 / 3.0, 0.05, 0.032,
                      0.05, kNone, 0.015,     0.5,  0.3,
                      0.2,  0.11,  0.01,      2.1,  detect::kCycleCaptured | detect::kCycleIsFirst};
  detect::Cycle last{1,     1030,  0.085, kNone, 0.082,
                     kNone, 0.03,  kNone, 0.49,  0.31,
                     0.18,  kNone, kNone, 1.9,   detect::kCycleHasSpike};
  return {first, last};
}

inline model::TestTruth sample_truth() {
  model::TestTruth truth;
  truth.scene_name = "sticks for ever";
  truth.scene_text = "name = \"sticks for ever\"\n";
  truth.seed = 0xFFFF'FFFF'FFFF'FFFEULL;
  truth.mu_s = 0.35;
  truth.mu_k = 0.3;
  truth.omega_rad_per_s = 125.6;
  truth.gamma_over_2omega = 0.022;
  truth.pull_speed_m_per_s = 0.00508;
  truth.regime = model::Regime::kStickSlip;
  truth.oscillation_frequency_Hz = 19.7;
  truth.static_coefficient = 0.3813;
  truth.kinetic_coefficient = 0.3019;
  truth.amplitude = 0.0786;
  truth.modes = {{0.0, 0.03, model::Mode::kStick}, {0.03, 0.05, model::Mode::kSlip}};
  truth.cycles = {{0.03, 0.351, 0.299}};
  truth.solver = model::SolverFacts{"exact closed forms", 1.8e-15, 1e-9, 84e-9};
  return truth;
}

inline record::EndRecord sample_end() {
  record::EndRecord end;
  end.unloaded_level = -0.0042;
  end.status = record::Status::kRecovered;
  end.reasons = {"disk full for 2 s", "grün"};
  end.cause = "unloaded";
  end.end_realtime_ns = 1'795'265'583'000'000'001;
  end.compute_time_s = 0.012;
  end.read_latency = daq::LatencyHistogram{{1200, 30, 0, 2}, 130e-6};
  end.results = sample_results();
  end.cycles = sample_cycles();
  end.spikes = {1003, 1041};
  end.truth = sample_truth();
  return end;
}

/// Scans 1000 … 1019 and 1040 … 1059: counts with both rails, a gap, every table filled.
inline record::Record sample_record() {
  record::Record record;
  record.header = sample_header();
  for (int i = 0; i < 40; ++i) {
    record.scan.push_back(i < 20 ? 1000 + i : 1020 + i);
    record.raw.push_back(i == 0 ? 0.0 : i == 39 ? 65535.0 : 30000.0 + 17.0 * i);
    record.second.push_back(i == 7 ? daq::SecondChannel::kNoCode : i == 39 ? 4095 : 100 * i);
    record.true_coefficient.push_back(i == 5 ? std::nan("") : 0.3 + 0.01 * std::sin(0.1 * i));
  }
  record.gaps = {{1020, 20, true, daq::GapCause::kOverrun}};
  record.anchors = {{1000, 5'000'000'000, 1'795'265'582'000'000'000},
                    {1059, 5'168'000'000, 1'795'265'582'168'000'000}};
  record.events = {{1020, 1'795'265'582'050'000'000, "board overran"}};
  record::set_end(record, sample_end());
  return record;
}

/// Complete, without a gap.
inline record::Record whole_record() {
  record::Record record = sample_record();
  for (std::size_t i = 0; i < record.scan.size(); ++i) record.scan[i] = 1000 + static_cast<std::int64_t>(i);
  record.gaps.clear();
  record.anchors = {{1000, 5'000'000'000, 1'795'265'582'000'000'000},
                    {1030, 5'085'714'000, 1'795'265'582'085'714'000}};
  record.end->status = record::Status::kComplete;
  record.end->reasons.clear();
  return record;
}

/// 20 coefficients, as from a CSV file: nothing known but rate and speed.
inline record::Record sample_imported() {
  record::Record record;
  record.header.uuid = "7d444840-9dc0-11d1-b245-5ffdce74fad2";
  record.header.board.driver = "import";
  record.header.board.quantity = daq::RawQuantity::kCoefficient;
  record.header.board.scan_rate_requested_Hz = 2000.0;
  record.header.board.scan_rate_granted_Hz = 2000.0;
  record.header.tester.pull_speed_m_per_s = 42e-6;
  for (int i = 0; i < 20; ++i) {
    record.scan.push_back(i);
    record.raw.push_back(std::sin(0.1 * i) / 3.0);
  }
  record.end.emplace().results = record::absent_results("not analysed");
  return record;
}

}  // namespace stickslip::test

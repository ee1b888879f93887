/// \file
/// Field-by-field comparison of records, NaN equal to NaN, everything else to the last bit.
#pragma once

#include <gtest/gtest.h>

#include <bit>

#include "core/record/fields.hpp"
#include "core/record/record.hpp"

namespace stickslip::test {

inline void expect_same_bits(double a, double b, const std::string& what) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b))
      << what << ": " << a << ", " << b;
}

inline void expect_same_header(const record::RecordHeader& a, const record::RecordHeader& b) {
  EXPECT_EQ(a.uuid, b.uuid);
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.test_number, b.test_number);
  EXPECT_EQ(a.trigger_scan, b.trigger_scan);
  EXPECT_EQ(a.start_realtime_ns, b.start_realtime_ns);
  EXPECT_EQ(a.board.driver, b.board.driver);
  EXPECT_EQ(a.board.board_name, b.board.board_name);
  EXPECT_EQ(a.board.device, b.board.device);
  EXPECT_EQ(a.board.subdevice, b.board.subdevice);
  EXPECT_EQ(a.board.channel, b.board.channel);
  EXPECT_EQ(a.board.quantity, b.board.quantity);
  EXPECT_EQ(a.board.maxdata, b.board.maxdata);
  EXPECT_EQ(a.board.range_min_V, b.board.range_min_V);
  EXPECT_EQ(a.board.range_max_V, b.board.range_max_V);
  EXPECT_EQ(a.board.polynomial, b.board.polynomial);
  EXPECT_EQ(a.board.expansion_origin, b.board.expansion_origin);
  EXPECT_EQ(a.board.calibration, b.board.calibration);
  EXPECT_EQ(a.board.acquisition, b.board.acquisition);
  EXPECT_EQ(a.board.scan_rate_requested_Hz, b.board.scan_rate_requested_Hz);
  EXPECT_EQ(a.board.scan_rate_granted_Hz, b.board.scan_rate_granted_Hz);
  EXPECT_EQ(a.board.second, b.board.second);
  ASSERT_EQ(a.load_cell.has_value(), b.load_cell.has_value());
  if (a.load_cell) {
    EXPECT_EQ(a.load_cell->gain_N_per_V, b.load_cell->gain_N_per_V);
    EXPECT_EQ(a.load_cell->zero_V, b.load_cell->zero_V);
  }
  EXPECT_EQ(a.calibration, b.calibration);
  EXPECT_EQ(a.tester, b.tester);
  EXPECT_EQ(a.sample, b.sample);
  EXPECT_EQ(a.process, b.process);
  EXPECT_EQ(a.plan, b.plan);
  EXPECT_EQ(a.self_check, b.self_check);
}

inline void expect_same_cycles(const base::LongColumn<detect::Cycle>& a,
                               const base::LongColumn<detect::Cycle>& b) {
  ASSERT_EQ(a.size(), b.size());
  record::for_each_cycle_column([&](const record::FieldName& name, auto member) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      expect_same_bits(static_cast<double>(a[i].*member), static_cast<double>(b[i].*member),
                       std::string{name.name});
    }
  });
}

inline void expect_same_truth(const model::TestTruth& a, const model::TestTruth& b) {
  EXPECT_EQ(a.scene_name, b.scene_name);
  EXPECT_EQ(a.scene_text, b.scene_text);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.mu_s, b.mu_s);
  EXPECT_EQ(a.mu_k, b.mu_k);
  EXPECT_EQ(a.omega_rad_per_s, b.omega_rad_per_s);
  EXPECT_EQ(a.gamma_over_2omega, b.gamma_over_2omega);
  EXPECT_EQ(a.pull_speed_m_per_s, b.pull_speed_m_per_s);
  EXPECT_EQ(a.regime, b.regime);
  EXPECT_EQ(a.oscillation_frequency_Hz, b.oscillation_frequency_Hz);
  EXPECT_EQ(a.amplitude, b.amplitude);
  EXPECT_EQ(a.static_coefficient, b.static_coefficient);
  EXPECT_EQ(a.kinetic_coefficient, b.kinetic_coefficient);
  EXPECT_EQ(a.solver, b.solver);
  ASSERT_EQ(a.modes.size(), b.modes.size());
  for (std::size_t i = 0; i < a.modes.size(); ++i) {
    EXPECT_EQ(a.modes[i].start_s, b.modes[i].start_s);
    EXPECT_EQ(a.modes[i].end_s, b.modes[i].end_s);
    EXPECT_EQ(a.modes[i].mode, b.modes[i].mode);
  }
  ASSERT_EQ(a.cycles.size(), b.cycles.size());
  for (std::size_t i = 0; i < a.cycles.size(); ++i) {
    EXPECT_EQ(a.cycles[i].onset_time_s, b.cycles[i].onset_time_s);
    EXPECT_EQ(a.cycles[i].mu_s, b.cycles[i].mu_s);
    EXPECT_EQ(a.cycles[i].mu_k, b.cycles[i].mu_k);
  }
}

inline void expect_same_end(const record::EndRecord& a, const record::EndRecord& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.reasons, b.reasons);
  EXPECT_EQ(a.cause, b.cause);
  EXPECT_EQ(a.end_realtime_ns, b.end_realtime_ns);
  EXPECT_EQ(a.compute_time_s, b.compute_time_s);
  EXPECT_EQ(a.read_latency, b.read_latency);
  EXPECT_EQ(a.results, b.results);
  ASSERT_EQ(a.truth.has_value(), b.truth.has_value());
  if (a.truth) expect_same_truth(*a.truth, *b.truth);
}

inline void expect_same_record(const record::Record& a, const record::Record& b) {
  expect_same_header(a.header, b.header);
  EXPECT_EQ(a.scan, b.scan);
  EXPECT_EQ(a.second, b.second);
  ASSERT_EQ(a.raw.size(), b.raw.size());
  for (std::size_t i = 0; i < a.raw.size(); ++i) expect_same_bits(a.raw[i], b.raw[i], "raw");
  ASSERT_EQ(a.true_coefficient.size(), b.true_coefficient.size());
  for (std::size_t i = 0; i < a.true_coefficient.size(); ++i) {
    expect_same_bits(a.true_coefficient[i], b.true_coefficient[i], "true_coefficient");
  }
  EXPECT_EQ(a.spikes, b.spikes);
  ASSERT_EQ(a.gaps.size(), b.gaps.size());
  for (std::size_t i = 0; i < a.gaps.size(); ++i) {
    EXPECT_EQ(a.gaps[i].first, b.gaps[i].first);
    EXPECT_EQ(a.gaps[i].count, b.gaps[i].count);
    EXPECT_EQ(a.gaps[i].estimated, b.gaps[i].estimated);
    EXPECT_EQ(a.gaps[i].cause, b.gaps[i].cause);
  }
  expect_same_cycles(a.cycles, b.cycles);
  EXPECT_EQ(a.anchors, b.anchors);
  EXPECT_EQ(a.events, b.events);
  ASSERT_EQ(a.end.has_value(), b.end.has_value());
  if (a.end) expect_same_end(*a.end, *b.end);
}

}  // namespace stickslip::test

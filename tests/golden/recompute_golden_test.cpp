// A file alone is enough: of a record of the daemon everything is deleted that can be computed, and computed
// again from the raw counts and the facts beside them. Each number is what the whole record gives, to the
// last bit, and what stood there, as far as a program that has changed since can say the same.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "core/evaluation/analyse.hpp"
#include "core/pipeline/self_check.hpp"
#include "core/record/reader.hpp"
#include "tests/support/record_equality.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;

/// A record that the daemon made of four seconds of stick-slip with spikes, missing scans, a calibrated load
/// cell and a characterised tester.
const fs::path kRecord{STICKSLIP_SOURCE_DIR "/tests/golden/records/2/daemon.h5"};

/// A copy with nothing left that follows from something else.
fs::path thinned(const test::TemporaryFolder& folder) {
  fs::path path = folder / "thinned.h5";
  fs::copy_file(kRecord, path);
  fs::permissions(path, fs::perms::owner_write, fs::perm_options::add);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  EXPECT_GE(file, 0);
  for (const char* name :
       {"raw/time", "raw/force", "raw/flags", "results", "cycles", "truth", "events", "collection_time",
        "self_check/zero", "self_check/zero_standard_error", "self_check/drift",
        "self_check/drift_standard_error", "self_check/noise", "self_check/hum_at_50_Hz",
        "self_check/hum_at_60_Hz", "self_check/hum_standard_error", "self_check/spike_count",
        "self_check/saturated_count"}) {
    EXPECT_GE(H5Ldelete(file, (std::string{"entry/"} + name).c_str(), H5P_DEFAULT), 0) << name;
  }
  EXPECT_GE(H5Fclose(file), 0);
  return path;
}

/// A fit ends where its cost falls by less than estimate::kFitSettled = 1e-5: within √(2 · 1e-5) = 0.0045 of
/// the standard errors of its minimum.
constexpr double kOfStandardError = 0.0045;
/// What has no standard error: a number worked out in another order.
constexpr double kRelative = 1e-9;

/// The scan at which the tester unloads; the version that made the record took the corner there for a spike.
constexpr daq::ScanIndex kUnloads = 1342;

std::vector<daq::ScanIndex> spikes_now(std::vector<daq::ScanIndex> then) {
  std::erase(then, kUnloads);
  return then;
}

void expect_close(const analysis::TestResults& now, const analysis::TestResults& then) {
  EXPECT_EQ(now.regime, then.regime);
  EXPECT_EQ(base::texts_of(now.findings), base::texts_of(then.findings));
  std::vector<analysis::Estimate> stored;
  analysis::for_each_result(then, [&](const analysis::ResultName&, const analysis::Estimate& estimate) {
    stored.push_back(estimate);
  });
  auto next = stored.begin();
  analysis::for_each_result(now, [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
    const analysis::Estimate& old = *next++;
    if (old.reason == record::kNoSuchResultThen) return;
    if (name.name == "spike_count") {
      EXPECT_EQ(*estimate.value, *old.value - 1.0);
      return;
    }
    EXPECT_EQ(estimate.reason, old.reason) << name.name;
    ASSERT_EQ(estimate.value.has_value(), old.value.has_value()) << name.name;
    ASSERT_EQ(estimate.standard_error.has_value(), old.standard_error.has_value()) << name.name;
    if (!old.value) return;
    const double error = old.standard_error.value_or(0.0);
    EXPECT_NEAR(*estimate.value, *old.value, kOfStandardError * error + kRelative * std::abs(*old.value))
        << name.name;
    EXPECT_NEAR(estimate.standard_error.value_or(0.0), error, kOfStandardError * error) << name.name;
  });
}

/// But for the evidence of the cycles, which were stored without. The times of a cycle are known to about the
/// part of them that S − K is.
void expect_close(const base::LongColumn<detect::Cycle>& now, const base::LongColumn<detect::Cycle>& then) {
  ASSERT_EQ(now.size(), then.size());
  const auto error_of = [](const detect::Cycle& cycle) {
    const double part = cycle.delta_mu_standard_error / cycle.delta_mu;
    return std::isfinite(part) ? part : 0.0;
  };
  record::for_each_cycle_column([&](const record::FieldName& name, auto member) {
    for (std::size_t i = 0; i < now.size(); ++i) {
      const auto a = static_cast<double>(now[i].*member);
      const auto b = static_cast<double>(then[i].*member);
      if (name.name.find("evidence") != std::string_view::npos || name.name == "live_decision_time") continue;
      if (std::isnan(b)) {
        EXPECT_TRUE(std::isnan(a)) << name.name << " of " << i;
      } else {
        const bool is_error = name.name.find("standard_error") != std::string_view::npos;
        const double part = is_error ? 1.0 : error_of(then[i]);
        EXPECT_NEAR(a, b, kOfStandardError * part * std::abs(b) + kRelative * std::max(std::abs(b), 1.0))
            << name.name << " of " << i;
      }
    }
  });
}

TEST(Recompute, EveryResultCycleAndSpikeFromRawCountsAndFacts) {
  const test::TemporaryFolder folder;
  const auto whole = record::read_record(kRecord);
  ASSERT_TRUE(whole) << whole.error().message;
  const auto thin = record::read_record(thinned(folder));
  ASSERT_TRUE(thin) << thin.error().message;
  ASSERT_FALSE(thin->end->results.mu_s.value);
  ASSERT_TRUE(thin->cycles.empty());
  ASSERT_TRUE(thin->spikes.empty());

  const auto again = evaluation::analyse(*thin);
  const auto from_whole = evaluation::analyse(*whole);

  ASSERT_TRUE(again) << again.error().message;
  ASSERT_TRUE(from_whole) << from_whole.error().message;
  EXPECT_EQ(again->results, from_whole->results);
  test::expect_same_cycles(again->cycles, from_whole->cycles);
  EXPECT_EQ(again->spikes, from_whole->spikes);

  const analysis::TestResults& stored = whole->end->results;
  // The record has what there is to compute: nothing is compared with nothing.
  EXPECT_TRUE(stored.mu_s.standard_error);
  EXPECT_TRUE(stored.mu_s.systematic_uncertainty);
  EXPECT_TRUE(stored.scan_rate_measured.value);
  EXPECT_GT(whole->cycles.size(), 10U);
  EXPECT_FALSE(whole->spikes.empty());
  EXPECT_FALSE(whole->gaps.empty());
  expect_close(again->results, stored);
  expect_close(again->cycles, whole->cycles);
  EXPECT_EQ(again->spikes, spikes_now(whole->spikes));
}

TEST(Recompute, SelfCheckFromItsScans) {
  const test::TemporaryFolder folder;
  const auto whole = record::read_record(kRecord);
  ASSERT_TRUE(whole) << whole.error().message;
  const auto thin = record::read_record(thinned(folder));
  ASSERT_TRUE(thin) << thin.error().message;
  ASSERT_TRUE(thin->header.self_check);
  const daq::SelfCheck& left = *thin->header.self_check;
  ASSERT_FALSE(left.noise_N);
  const double load_N = thin->header.tester.tester().normal_load_N();
  const daq::Calibration calibration{thin->header.board, *thin->header.load_cell, load_N};
  // The rate by the clock is a fact of then.
  std::optional<daq::RateEstimate> rate;
  if (left.scan_rate_Hz) rate = daq::RateEstimate{*left.scan_rate_Hz, *left.scan_rate_standard_error_Hz, 0};

  const daq::SelfCheck again = pipeline::check_idle(left.first_scan, left.raw, calibration,
                                                    thin->header.board.scan_rate_granted_Hz, rate);

  EXPECT_TRUE(whole->header.self_check->hum_at_50_Hz_N);
  EXPECT_EQ(again, *whole->header.self_check);
}

}  // namespace
}  // namespace stickslip

// A file alone is enough: of a record of the daemon everything is deleted that can be computed, and computed
// again from the raw counts and the facts beside them. Each number is what stood there, to the last bit.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <filesystem>

#include "core/pipeline/self_check.hpp"
#include "core/record/reader.hpp"
#include "daemon/analyse.hpp"
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

TEST(Recompute, EveryResultCycleAndSpikeFromRawCountsAndFacts) {
  const test::TemporaryFolder folder;
  const auto whole = record::read_record(kRecord);
  ASSERT_TRUE(whole) << whole.error().message;
  const auto thin = record::read_record(thinned(folder));
  ASSERT_TRUE(thin) << thin.error().message;
  ASSERT_FALSE(thin->end->results.mu_s.value);
  ASSERT_TRUE(thin->cycles.empty());
  ASSERT_TRUE(thin->spikes.empty());

  const auto again = daemon::analyse(*thin);

  ASSERT_TRUE(again) << again.error().message;
  const friction::TestResults& results = whole->end->results;
  // The record has what there is to compute: nothing is compared with nothing.
  EXPECT_TRUE(results.mu_s.standard_error);
  EXPECT_TRUE(results.mu_s.systematic_uncertainty);
  EXPECT_TRUE(results.scan_rate_measured.value);
  EXPECT_GT(whole->cycles.size(), 10U);
  EXPECT_FALSE(whole->spikes.empty());
  EXPECT_FALSE(whole->gaps.empty());
  EXPECT_EQ(again->results, results);
  base::LongColumn<friction::Cycle> kept;  // That record was made before cycles had their evidence.
  for (friction::Cycle cycle : again->cycles) {
    EXPECT_TRUE(std::isfinite(cycle.capture_evidence) || kept.size() + 1 == again->cycles.size());
    cycle.capture_evidence = cycle.live_capture_evidence = cycle.live_decision_time_s =
        std::numeric_limits<double>::quiet_NaN();
    kept.push_back(cycle);
  }
  test::expect_same_cycles(kept, whole->cycles);
  EXPECT_EQ(again->spikes, whole->spikes);
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

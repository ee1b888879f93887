#include "io/verify.hpp"

#include <gmock/gmock.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include <limits>

#include <nlohmann/json.hpp>

#include "core/record/finaliser.hpp"
#include "tests/support/journal_samples.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::io {
namespace {

using record::judge;
using record::Judgement;
using record::Verdict;
using test::TemporaryFolder;
using testing::HasSubstr;
namespace fs = std::filesystem;

std::string findings_of(const Verdict& verdict) {
  std::string text;
  for (const auto& finding : verdict.findings)
    text += fmt::format("{} {}: {}\n", record::name(finding.weight), finding.place, finding.text);
  return text;
}

Verdict verdict_on(const record::Record& record) {
  const TemporaryFolder folder;
  const auto published = record::publish_record(record, folder / "a.h5");
  EXPECT_TRUE(published) << (published ? "" : published.error().message);
  return judge(folder / "a.h5");
}

TEST(Verify, AWholeRecordIsComplete) {
  const Verdict verdict = verdict_on(test::whole_record());
  EXPECT_EQ(verdict.judgement, Judgement::kComplete) << findings_of(verdict);
  EXPECT_EQ(findings_of(verdict), "");
  EXPECT_EQ(verdict.kind, "record");
  EXPECT_EQ(verdict.status, "complete");
  EXPECT_EQ(verdict.scans_present, 40);
  EXPECT_EQ(verdict.scans_committed, 40);
  EXPECT_EQ(verdict.sha256_found, verdict.sha256_stored);
  EXPECT_EQ(verdict.sha256_found.size(), 64U);
}

TEST(Verify, ImportedValuesAreJudgedByThemselves) {
  EXPECT_EQ(findings_of(verdict_on(test::sample_imported())), "");
}

TEST(Verify, SaysWhyARecordIsNotComplete) {
  const Verdict verdict = verdict_on(test::sample_record());
  EXPECT_EQ(verdict.judgement, Judgement::kIncomplete);
  EXPECT_EQ(findings_of(verdict),
            "incomplete process/status: recovered: disk full for 2 s; grün\n"
            "incomplete gaps: about 20 scans missing from scan 1020: overrun\n");
  ASSERT_EQ(verdict.gaps.size(), 1U);
}

TEST(Verify, AJumpThatNoGapExplainsIsDamage) {
  record::Record record = test::whole_record();
  for (std::size_t i = 20; i < record.scan.size(); ++i) record.scan[i] += 7;
  EXPECT_THAT(findings_of(verdict_on(record)),
              HasSubstr("damage entry/raw/scan row 20: the scans jump where gaps/first_scan has no gap"));
  record.gaps = {{1020, 3, false, daq::GapCause::kRingFull}, {1023, 4, true, daq::GapCause::kOverrun}};
  EXPECT_EQ(verdict_on(record).judgement, Judgement::kIncomplete);  // Two gaps, one behind the other.
  record.gaps[1].count = 5;
  EXPECT_EQ(verdict_on(record).judgement, Judgement::kDamaged);
}

TEST(Verify, ClocksThatContradictEachOtherAreFound) {
  record::Record record = test::whole_record();
  std::swap(record.anchors[0].monotonic_ns, record.anchors[1].monotonic_ns);
  EXPECT_THAT(findings_of(verdict_on(record)), HasSubstr("timing row 1: the monotonic clock does not rise"));
  record = test::whole_record();
  std::swap(record.anchors[0], record.anchors[1]);
  EXPECT_THAT(findings_of(verdict_on(record)), HasSubstr("timing row 1: the scans do not rise"));
  record = test::whole_record();
  record.anchors[1].scan = 1040;
  EXPECT_THAT(findings_of(verdict_on(record)), HasSubstr("timing row 1: scan 1040 is not of this test"));
}

TEST(Verify, ClocksAnAgeApartAreAWordNotAnOverflow) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  record::Record record = test::whole_record();
  record.anchors = {{1000, 0, kMost}, {1030, kMost, 0}};
  EXPECT_THAT(findings_of(verdict_on(record)),
              HasSubstr("note timing: the clock of the day was set by -18446744073.710 s during the test"));
}

/// Six anchors, 10 scans apart, of a board that runs at `rate_Hz`.
record::Record with_clocks(double rate_Hz) {
  record::Record record = test::whole_record();
  record.anchors.clear();
  for (std::int64_t i = 0; i < 4; ++i) {
    for (const std::int64_t half : {0, 5}) {
      const std::int64_t scan = 10 * i + half;
      const auto time_ns = static_cast<std::int64_t>(static_cast<double>(scan) / rate_Hz * 1e9);
      record.anchors.push_back({1000 + scan, 5'000'000'000 + time_ns, 1'795'265'582'000'000'000 + time_ns});
    }
  }
  return record;
}

TEST(Verify, ARateThatTheClocksDenyIsFound) {
  EXPECT_EQ(findings_of(verdict_on(with_clocks(350.0 * 1.009))), "");
  EXPECT_THAT(findings_of(verdict_on(with_clocks(350.0 * 1.011))),
              HasSubstr("incomplete timing: the clocks say 353.850 Hz, the board granted 350.000 Hz"));
}

/// Its scans from this one on were read in a burst, at 1 µs each, a minute after the first of them.
record::Record read_in_a_burst(std::int64_t from) {
  record::Record record = with_clocks(350.0);
  std::int64_t read_ns = 0;
  for (record::ClockAnchor& anchor : record.anchors) {
    if (anchor.scan < from) continue;
    if (read_ns == 0) read_ns = anchor.monotonic_ns + 60'000'000'000;
    anchor.monotonic_ns = read_ns += 1'000;
    anchor.realtime_ns = 1'795'265'582'000'000'000 + read_ns - 5'000'000'000;
  }
  return record;
}

TEST(Verify, ScansThatWereReadLateDenyNoRate) {
  for (const std::int64_t from : {1000, 1015}) {
    const Verdict verdict = verdict_on(read_in_a_burst(from));
    EXPECT_EQ(verdict.judgement, Judgement::kComplete) << from;
    EXPECT_EQ(findings_of(verdict),
              "note timing: the scans were read late: their clock readings cannot tell the scan rate\n");
  }
  EXPECT_EQ(findings_of(verdict_on(read_in_a_burst(1025))), "");  // Five before it are enough.
}

TEST(Verify, AClockOfTheDayThatWasSetIsAWordNotDamage) {
  record::Record record = test::whole_record();
  record.anchors[1].realtime_ns += 3'600'000'000'000;
  const Verdict verdict = verdict_on(record);
  EXPECT_EQ(verdict.judgement, Judgement::kComplete);
  EXPECT_THAT(findings_of(verdict), HasSubstr("note timing: the clock of the day was set by 3600.000 s"));
}

TEST(Verify, MissingConfigurationIsSaid) {
  record::Record record = test::whole_record();
  record.header.process.configuration.clear();
  EXPECT_THAT(findings_of(verdict_on(record)), HasSubstr("incomplete process/configuration: is missing"));
}

/// Removes or rewrites an object of a published record with HDF5 itself, as a stranger's tool would.
template <typename Change>
Verdict after(const Change& change) {
  const TemporaryFolder folder;
  EXPECT_TRUE(record::publish_record(test::whole_record(), folder / "a.h5"));
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  change(file);
  H5Fclose(file);
  return judge(folder / "a.h5");
}

TEST(Verify, AColumnOfTrueSlipsWithAnotherNumberOfRowsIsDamage) {
  for (const char* column : {"mu_s", "mu_k"}) {
    const Verdict verdict = after([&](hid_t file) {
      const hid_t cycles = H5Gopen2(file, "/entry/truth/cycles", H5P_DEFAULT);
      EXPECT_GE(H5Ldelete(cycles, column, H5P_DEFAULT), 0);
      const hsize_t rows = 7;
      const hid_t space = H5Screate_simple(1, &rows, nullptr);
      H5Dclose(H5Dcreate2(cycles, column, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      H5Sclose(space);
      H5Gclose(cycles);
    });
    EXPECT_EQ(verdict.judgement, Judgement::kDamaged);
    EXPECT_THAT(findings_of(verdict), HasSubstr(fmt::format("entry/truth: {} has 7 rows, not", column)));
  }
}

TEST(Verify, WhatWasChangedAfterPublishingIsFound) {
  const Verdict count = after([](hid_t file) {
    const hid_t dataset = H5Dopen2(file, "/entry/process/scan_count", H5P_DEFAULT);
    const std::int64_t other = 41;
    H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &other);
    H5Dclose(dataset);
  });
  EXPECT_THAT(findings_of(count), HasSubstr("process/scan_count: 41 scans were committed, 40 are here"));
  EXPECT_THAT(findings_of(count), HasSubstr("file: is not as it was published"));

  const Verdict result = after([](hid_t file) {
    const hid_t dataset = H5Dopen2(file, "/entry/results/mu_s", H5P_DEFAULT);
    const double other = 0.5;
    H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &other);
    H5Dclose(dataset);
  });
  EXPECT_EQ(findings_of(result),
            "damage file: is not as it was published: process/file_sha256 does not match\n");

  const Verdict calibration =
      after([](hid_t file) { H5Ldelete(file, "/entry/instrument/calibration/gain", H5P_DEFAULT); });
  EXPECT_THAT(findings_of(calibration), HasSubstr("instrument/calibration/gain: is missing"));

  const Verdict gone = after([](hid_t file) { H5Ldelete(file, "/entry/raw", H5P_DEFAULT); });
  EXPECT_EQ(gone.judgement, Judgement::kDamaged);
}

// What the force and the times are is known from the counts: a consistent forgery of one column is found even
// where all checksums of HDF5 are right.
TEST(Verify, ColumnsThatDoNotFollowFromTheCountsAreFound) {
  const Verdict verdict = after([](hid_t file) {
    const hid_t dataset = H5Dopen2(file, "/entry/raw/force", H5P_DEFAULT);
    std::vector<float> force(40);
    H5Dread(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, force.data());
    force[7] *= 1.001F;
    H5Dwrite(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, force.data());
    H5Dclose(dataset);
  });
  EXPECT_THAT(findings_of(verdict),
              HasSubstr("entry/raw/force row 7: the force does not follow from the raw values"));
}

/// Sets the last of the whole numbers of a column.
Verdict with_last(const char* column, std::int64_t value) {
  return after([&](hid_t file) {
    const hid_t dataset = H5Dopen2(file, column, H5P_DEFAULT);
    const hid_t space = H5Dget_space(dataset);
    std::vector<std::int64_t> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    values.back() = value;
    H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Sclose(space);
    H5Dclose(dataset);
  });
}

TEST(Verify, ScansAndClocksThatCannotBeAreDamage) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  const auto expect_damage = [](const char* column, std::int64_t value, const char* words) {
    const Verdict verdict = with_last(column, value);
    EXPECT_EQ(verdict.judgement, Judgement::kDamaged) << column;
    EXPECT_THAT(findings_of(verdict), HasSubstr(words)) << column;
  };
  expect_damage("/entry/raw/scan", kMost, "scan 9223372036854775807 lies outside of 0 to 9007199254740992");
  expect_damage("/entry/timing/scan", kLeast, "scan -9223372036854775808 lies outside of 0 to");
  expect_damage("/entry/timing/monotonic_raw", -1, "no clock shows -1 ns and 1795265582085714000 ns");
  expect_damage("/entry/timing/realtime", -1, "no clock shows 5085714000 ns and -1 ns: below zero");
  expect_damage("/entry/events/scan", -1, "scan -1 lies outside of 0 to");
}

TEST(Verify, TextsOfVariableLengthAreNotReadWhateverTheirLayout) {
  for (const bool is_chunked : {false, true}) {
    const Verdict verdict = after([&](hid_t file) {
      const hid_t type = H5Tcopy(H5T_C_S1);
      H5Tset_size(type, H5T_VARIABLE);
      const hsize_t rows = 2;
      const hid_t space = H5Screate_simple(1, &rows, nullptr);
      const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
      if (is_chunked) H5Pset_chunk(layout, 1, &rows);
      H5Dclose(H5Dcreate2(file, "/entry/remarks", type, space, H5P_DEFAULT, layout, H5P_DEFAULT));
      H5Pclose(layout);
      H5Sclose(space);
      H5Tclose(type);
    });
    EXPECT_EQ(findings_of(verdict),
              "damage file: is not as it was published: process/file_sha256 does not match\n");
  }
}

TEST(Verify, AnOlderRecordWithoutSealIsComplete) {
  const Verdict verdict = after([](hid_t file) {
    H5Ldelete(file, "/entry/process/file_sha256", H5P_DEFAULT);
    H5Ldelete(file, "/entry/process/scan_count", H5P_DEFAULT);
  });
  EXPECT_EQ(verdict.judgement, Judgement::kComplete) << findings_of(verdict);
  EXPECT_THAT(findings_of(verdict), HasSubstr("note file: was made before records had a checksum"));
}

TEST(Verify, AVersionThatIsNotReadIsRefusedByName) {
  for (const std::int64_t version : {999, 0, -1}) {
    const Verdict verdict = after([&](hid_t file) {
      const hid_t attribute = H5Aopen(file, "format_version", H5P_DEFAULT);
      H5Awrite(attribute, H5T_NATIVE_INT64, &version);
      H5Aclose(attribute);
    });
    EXPECT_EQ(verdict.judgement, Judgement::kNotJudged) << version;
    EXPECT_EQ(findings_of(verdict),
              fmt::format("note format_version: {}\n", record::version_refusal(version)));
  }
}

// ---- journals -----------------------------------------------------------------------------

TEST(Verify, AJournalSaysWhetherItsTestEnded) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::whole_record());
  test::write_journal(folder / "b.journal", test::whole_record(), false);
  const Verdict ended = judge(folder / "a.journal");
  EXPECT_EQ(ended.judgement, Judgement::kIncomplete);
  EXPECT_EQ(ended.scans_present, 40);
  EXPECT_THAT(findings_of(ended), HasSubstr("is the journal of a test that ended"));
  EXPECT_THAT(findings_of(judge(folder / "b.journal")),
              HasSubstr("is the journal of a test that has not ended"));
}

TEST(Verify, AJournalHasTheFormatVersionOfItsHeader) {
  for (const std::int64_t version : {1, 2, 3}) {
    const fs::path journal = fs::path{STICKSLIP_SOURCE_DIR} / "tests/golden/records" /
                             std::to_string(version) / "every-field.journal";
    EXPECT_EQ(judge(journal).format_version, version);
  }
}

TEST(Verify, AFlippedBitAnywhereInAJournalIsDamageATornEndIsNot) {
  const TemporaryFolder folder;
  const auto sizes = test::write_journal(folder / "a.journal", test::whole_record());
  const std::string whole = test::content_of(folder / "a.journal");
  for (std::size_t byte = 0; byte < sizes[sizes.size() - 2]; byte += 7) {
    std::string flipped = whole;
    flipped[byte] = static_cast<char>(flipped[byte] ^ (1 << (byte % 8)));
    test::write_content(folder / "b.journal", flipped);
    ASSERT_EQ(judge(folder / "b.journal").judgement, Judgement::kDamaged) << "byte " << byte;
  }
  for (std::size_t size = 0; size < whole.size(); size += 11) {
    test::write_content(folder / "b.journal", whole.substr(0, size));
    ASSERT_EQ(judge(folder / "b.journal").judgement, Judgement::kIncomplete) << size << " bytes";
  }
}

// ---- any file -----------------------------------------------------------------------------

TEST(Verify, StrangersAreNotJudged) {
  const TemporaryFolder folder;
  test::write_content(folder / "notes.txt", "not a record");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const hid_t other = H5Fcreate((folder / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(other);
  for (const fs::path& path :
       {folder / "notes.txt", folder / "nothing", folder / "pipe", folder.path(), folder / "other.h5"}) {
    EXPECT_EQ(judge(path).judgement, Judgement::kNotJudged) << path;
  }
  test::write_content(folder / "cut.h5", "not a record");
  EXPECT_EQ(judge(folder / "cut.h5").judgement, Judgement::kDamaged);
}

TEST(Verify, ARecordCutAnywhereIsDamaged) {
  const TemporaryFolder folder;
  ASSERT_TRUE(record::publish_record(test::whole_record(), folder / "a.h5"));
  const std::string whole = test::content_of(folder / "a.h5");
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 97) {
    test::write_content(folder / "b.h5", whole.substr(0, size));
    const VerifyOutput output = verify_files({(folder / "b.h5").string()}, false);
    ASSERT_EQ(output.exit_status, kSomeDamaged) << size << " bytes: " << output.text;
  }
}

TEST(Verify, TheWorstFileDecidesTheExitStatus) {
  const TemporaryFolder folder;
  ASSERT_TRUE(record::publish_record(test::whole_record(), folder / "good.h5"));
  ASSERT_TRUE(record::publish_record(test::sample_record(), folder / "gap.h5"));
  test::write_content(folder / "bad.h5", "nothing");
  const auto status = [&](std::vector<std::string> names) {
    for (std::string& name : names) name = (folder / name).string();
    return verify_files(names, false).exit_status;
  };
  EXPECT_EQ(status({"good.h5"}), 0);
  EXPECT_EQ(status({"good.h5", "gap.h5"}), 1);
  EXPECT_EQ(status({"good.h5", "gap.h5", "absent.h5"}), 4);
  EXPECT_EQ(status({"good.h5", "bad.h5", "absent.h5"}), 3);
}

TEST(Verify, TextAndJsonSayTheSame) {
  const TemporaryFolder folder;
  const std::string file = (folder / "gap.h5").string();
  ASSERT_TRUE(record::publish_record(test::sample_record(), file));
  const auto json = nlohmann::json::parse(verify_files({file}, true).text)["files"][0];
  EXPECT_EQ(json["judgement"], "incomplete");
  EXPECT_EQ(json["gaps"][0]["cause"], "overrun");
  EXPECT_EQ(json["scans_present"], 40);
  const std::string text = verify_files({file}, false).text;
  EXPECT_THAT(text, HasSubstr("incomplete  " + file + ": record version"));
  EXPECT_THAT(text, HasSubstr(", 40 scans, 1 gaps, recovered\n"));
  EXPECT_THAT(text, HasSubstr("  incomplete  gaps: about 20 scans missing from scan 1020: overrun\n"));
}

}  // namespace
}  // namespace stickslip::io

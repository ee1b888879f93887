#include <gmock/gmock.h>
#include <hdf5.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numeric>

#include "core/base/sanitized.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/reader.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/journal_samples.hpp"
#include "tests/support/lacking_disk.hpp"
#include "tests/support/record_equality.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

using record::finalise;
using record::publish_record;
using record::read_record;
using test::TemporaryFolder;
using testing::HasSubstr;
namespace fs = std::filesystem;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator{folder}) names.push_back(file.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(RecordFile, WithoutAnalysisSaysWhyItHasNoRung) {
  const TemporaryFolder folder;
  ASSERT_TRUE(publish_record(test::sample_imported(), folder / "a.h5"));
  const auto read = read_record(folder / "a.h5");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->end->results.rung, analysis::Rung::kNone);
  EXPECT_EQ(read->end->results.rung_reason, "not analysed");
}

TEST(RecordFile, IsWrittenWhileItsEndIsComputed) {
  const TemporaryFolder folder;
  const record::Record whole = test::sample_record();
  record::Record record = whole;
  record::EndRecord end = *whole.end;
  end.spikes = {1003, 1059};
  record.spikes.clear();
  const record::RecordScans scans{record};
  ASSERT_TRUE(
      publish_record(record, scans, folder / "a.h5", [&] { return base::Result<record::EndRecord>{end}; }));
  const auto read = read_record(folder / "a.h5");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->spikes, end.spikes);
  EXPECT_EQ(read->end->results, whole.end->results);

  const auto refused =
      publish_record(record, scans, folder / "b.h5",
                     []() -> base::Result<record::EndRecord> { return base::usage_error("no speed"); });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "no speed");
  EXPECT_EQ(refused.error().exit_status(), 2);
  EXPECT_THROW(static_cast<void>(publish_record(record, scans, folder / "b.h5",
                                                []() -> base::Result<record::EndRecord> {
                                                  throw std::system_error{ENOSPC, std::generic_category()};
                                                })),
               std::system_error);
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.h5"});
}

TEST(RecordFile, HasTheDiagnosticsApartFromTheOtherResults) {
  const TemporaryFolder folder;
  ASSERT_TRUE(publish_record(test::sample_record(), folder / "a.h5"));
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const auto is_there = [file](const std::string& path) {
    return H5Lexists(file, path.c_str(), H5P_DEFAULT) > 0;
  };
  for (const std::string group : {"entry/results/", "numbers/results/"}) {
    analysis::TestResults names;
    analysis::for_each_result(names, [&](const analysis::ResultName& name, analysis::Estimate&) {
      const std::string own{name.name};
      EXPECT_EQ(is_there(group + own), !name.is_diagnostic) << group << own;
      EXPECT_EQ(is_there(group + "diagnostics/" + own), name.is_diagnostic) << group << own;
    });
  }
  H5Fclose(file);
}

TEST(RecordFile, GivesBackEveryFieldOfATest) {
  const TemporaryFolder folder;
  const record::Record written = test::sample_record();
  test::write_journal(folder / "a.journal", written);

  const auto file = finalise(folder / "a.journal");

  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->file, folder / "a.h5");
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.h5"});  // Neither journal nor .part.
  const auto read = read_record(file->file);
  ASSERT_TRUE(read) << read.error().message;
  test::expect_same_record(*read, written);
}

TEST(RecordFile, ImportedValuesKeepEveryBitAndNothingIsInvented) {
  const TemporaryFolder folder;
  const record::Record written = test::sample_imported();
  const auto published = publish_record(written, folder / "a.h5");
  ASSERT_TRUE(published) << published.error().message;
  const auto read = read_record(folder / "a.h5");
  ASSERT_TRUE(read) << read.error().message;
  test::expect_same_record(*read, written);
  EXPECT_FALSE(read->header.tester.sled_mass_kg);
  EXPECT_FALSE(read->header.load_cell);
  EXPECT_FALSE(read->header.start_realtime_ns);
}

// 2³¹ s and 2³² s after 1970 are in 2038 and 2106: where a count of seconds with 32 bits turns over. Dates by
// `date -u -d @2147483648`.
TEST(RecordFile, TimesBeyond32BitsOfSecondsKeepTheirNanoseconds) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  for (const auto& [bits, text] :
       {std::pair{31, "2038-01-19T03:14:08"}, std::pair{32, "2106-02-07T06:28:16"}}) {
    const std::int64_t turn_ns = (std::int64_t{1} << bits) * kSecond_ns;
    EXPECT_EQ(record::iso_time(turn_ns), std::string{text} + ".000000000+00:00");
    EXPECT_EQ(record::ns_from_iso_time(record::iso_time(turn_ns - 1)), turn_ns - 1);
    const TemporaryFolder folder;
    record::Record written = test::sample_record();
    const std::int64_t shift_ns = turn_ns - written.anchors.at(1).realtime_ns;
    written.header.start_realtime_ns = *written.header.start_realtime_ns + shift_ns;
    written.end->end_realtime_ns = *written.end->end_realtime_ns + shift_ns;
    for (daq::ClockAnchor& anchor : written.anchors) {
      anchor.realtime_ns += shift_ns;
      anchor.monotonic_ns += turn_ns;  // A machine that has run for as long.
    }
    ASSERT_LT(written.anchors.front().realtime_ns, turn_ns);
    ASSERT_TRUE(publish_record(written, folder / "a.h5"));
    const auto read = read_record(folder / "a.h5");
    ASSERT_TRUE(read) << read.error().message;
    test::expect_same_record(*read, written);
  }
}

// Computed independently, with Python: sha256 of
// struct.pack('<3d', 1.0, -2.5, 0.1).
TEST(RecordFile, Sha256IsThatOfTheStoredBytes) {
  const TemporaryFolder folder;
  record::Record record = test::sample_imported();
  record.raw = {1.0, -2.5, 0.1};
  record.scan = {0, 1, 2};
  ASSERT_TRUE(publish_record(record, folder / "a.h5"));
  EXPECT_EQ(read_record(folder / "a.h5")->sha256,
            "71da1541228ec3b80f80a42910c0512bc24ce229e09875fa2684836df5f229ee");
}

TEST(RecordFile, EqualRecordsAreEqualFiles) {
  const TemporaryFolder folder;
  ASSERT_TRUE(publish_record(test::sample_record(), folder / "a.h5"));
  ASSERT_TRUE(publish_record(test::sample_record(), folder / "b.h5"));
  EXPECT_EQ(test::content_of(folder / "a.h5"), test::content_of(folder / "b.h5"));
}

TEST(RecordFile, HoldsSeveralChunksAndWideCounts) {
  const TemporaryFolder folder;
  record::Record record = test::sample_record();
  record.header.board.maxdata = 0xFF'FFFF;
  record.scan.resize(100'000);
  std::iota(record.scan.begin(), record.scan.end(), 5);
  record.raw.clear();
  for (const auto scan : record.scan) record.raw.push_back(static_cast<double>(scan * 7919 % 0xFF'FFFF));
  record.true_coefficient.clear();
  for (const auto scan : record.scan) record.true_coefficient.push_back(1.0 / static_cast<double>(scan));
  record.second.clear();
  for (const auto scan : record.scan) record.second.push_back(static_cast<std::int32_t>(scan * 31 % 4096));
  record.spikes.clear();
  ASSERT_TRUE(publish_record(record, folder / "a.h5"));
  const auto read = read_record(folder / "a.h5");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->raw, record.raw);
  EXPECT_EQ(read->scan, record.scan);
  EXPECT_EQ(read->second, record.second);
}

TEST(RecordFile, ATestWithoutScansIsStillARecord) {
  const TemporaryFolder folder;
  record::Record record;
  record.header = test::sample_header();
  record.end.emplace().results = record::absent_results("no scans");
  const auto published = publish_record(record, folder / "a.h5");
  ASSERT_TRUE(published) << published.error().message;
  const auto read = read_record(folder / "a.h5");
  ASSERT_TRUE(read) << read.error().message;
  test::expect_same_record(*read, record);
}

TEST(RecordFile, IsNeverWrittenAgain) {
  const TemporaryFolder folder;
  test::write_content(folder / "a.h5", "precious");
  const auto published = publish_record(test::sample_record(), folder / "a.h5");
  ASSERT_FALSE(published);
  EXPECT_EQ(published.error().exit_status(), 2);
  EXPECT_THAT(published.error().message, HasSubstr("a.h5: exists already"));

  test::write_journal(folder / "a.journal", test::sample_record());
  EXPECT_FALSE(finalise(folder / "a.journal"));
  EXPECT_EQ(test::content_of(folder / "a.h5"), "precious");
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"a.h5", "a.journal"}));
}

TEST(RecordFile, FolderThatCannotBeWrittenLeavesNothing) {
  const TemporaryFolder folder;
  const auto published = publish_record(test::sample_record(), folder / "missing/a.h5");
  ASSERT_FALSE(published);
  EXPECT_EQ(published.error().exit_status(), 1);
  EXPECT_THAT(published.error().message, HasSubstr("No such file or directory"));
  EXPECT_TRUE(names_in(folder.path()).empty());
}

// RLIMIT_FSIZE stands for a full disk: at every size that is too small the journal is all that is
// left, and the finaliser ends by itself. In a process of its own, as it is meant to run.
TEST(RecordFile, FullDiskLeavesTheJournalOnly) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::sample_record());
  ASSERT_TRUE(publish_record(test::sample_record(), folder / "size.h5"));
  const auto needed = fs::file_size(folder / "size.h5");
  fs::remove(folder / "size.h5");
  const std::string journal = test::content_of(folder / "a.journal");

  for (std::uintmax_t limit = 0; limit < needed; limit += needed / 16) {
    EXPECT_EXIT(
        {
          std::signal(SIGXFSZ, SIG_IGN);
          rlimit tight{};
          tight.rlim_cur = tight.rlim_max = limit;
          setrlimit(RLIMIT_FSIZE, &tight);
          const auto file = finalise(folder / "a.journal");
          std::exit(file ? 0 : file.error().exit_status());
        },
        testing::ExitedWithCode(1), "")
        << limit;
    EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.journal"}) << limit;
    EXPECT_EQ(test::content_of(folder / "a.journal"), journal);
  }
}

TEST(Finalise, JournalWithoutEndBecomesAnInterruptedRecord) {
  const TemporaryFolder folder;
  const record::Record written = test::sample_record();
  test::write_journal(folder / "a.journal", written, false);

  const auto file = finalise(folder / "a.journal");

  ASSERT_TRUE(file) << file.error().message;
  const auto read = read_record(file->file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->end->status, record::Status::kInterrupted);
  EXPECT_EQ(read->end->cause, "program-died");
  EXPECT_EQ(read->end->reasons, std::vector<std::string>{"the program stopped before the end of the test"});
  EXPECT_EQ(read->end->results, record::absent_results("interrupted"));
  EXPECT_EQ(read->raw, written.raw);
  test::expect_same_cycles(read->cycles, written.cycles);  // As noted while it ran.
  EXPECT_EQ(read->spikes, written.spikes);
}

TEST(Finalise, InterruptedTestGetsTheResultsOfItsEvaluation) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::sample_record(), false);
  const auto file = finalise(folder / "a.journal", [](const record::Record& record) {
    EXPECT_EQ(record.raw.size(), 40U);
    return test::sample_end();
  });
  ASSERT_TRUE(file) << file.error().message;
  const auto read = read_record(file->file);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->end->status, record::Status::kInterrupted);
  EXPECT_EQ(read->end->results, test::sample_results());
}

TEST(Finalise, TornJournalKeepsWhatIsWholeAndSaysSo) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::sample_record(), false);
  const std::string whole = test::content_of(folder / "a.journal");
  test::write_content(folder / "a.journal", whole + "SSJ1torn!");
  const auto file = finalise(folder / "a.journal");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.h5"});
  const auto read = read_record(file->file);
  ASSERT_TRUE(read);
  EXPECT_THAT(read->end->reasons.back(), HasSubstr("9 bytes at the end of the journal"));
  EXPECT_EQ(read->raw, test::sample_record().raw);
}

// The program died: when the test ended is known from its scans, whenever its record is made.
TEST(Finalise, ATestThatWasInterruptedEndedWithItsLastScan) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::sample_record(), false);
  const auto file = finalise(folder / "a.journal");
  ASSERT_TRUE(file) << file.error().message;
  const auto read = read_record(file->file);
  ASSERT_TRUE(read) << read.error().message;
  const auto end = record::realtime_at(read->header, read->scan.back() + 1);
  ASSERT_TRUE(end);
  EXPECT_EQ(read->end->end_realtime_ns, end);
}

std::string with_a_flip(std::string content, std::size_t at) {
  content[at] = static_cast<char>(content[at] ^ 1);
  return content;
}

TEST(Finalise, AnEndThatKnewMoreScansIsEvaluatedAgain) {
  const TemporaryFolder folder;
  const auto sizes = test::write_journal(folder / "a.journal", test::whole_record());
  const std::string damaged = with_a_flip(test::content_of(folder / "a.journal"), sizes[3] - 1);
  test::write_content(folder / "a.journal", damaged);
  std::size_t evaluated = 0;
  const auto evaluate = [&evaluated](const record::Record& record) {
    evaluated = record.raw.size();
    record::EndRecord end;
    end.results = record::absent_results("again");
    return end;
  };

  const auto made = finalise(folder / "a.journal", evaluate);

  ASSERT_TRUE(made) << made.error().message;
  const auto read = read_record(made->file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(evaluated, read->raw.size());
  EXPECT_LT(read->raw.size(), 40U);
  EXPECT_EQ(made->scan_count, static_cast<std::int64_t>(read->raw.size()));
  EXPECT_EQ(read->end->results, record::absent_results("again"));
  EXPECT_EQ(read->end->status, record::Status::kIncomplete);
  EXPECT_EQ(read->end->cause, test::whole_record().end->cause);
  EXPECT_TRUE(read->end->truth);
  EXPECT_THAT(read->end->reasons.back(),
              HasSubstr(fmt::format("{} of {} bytes of the journal could not be read", made->damaged_size,
                                    damaged.size())));
  EXPECT_EQ(made->kept, folder / "a.journal.damaged");
  EXPECT_EQ(test::content_of(made->kept), damaged);
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"a.h5", "a.journal.damaged"}));
}

TEST(Finalise, ADamagedJournalReplacesNoOtherAndStaysWhereItIs) {
  const TemporaryFolder folder;
  const auto sizes = test::write_journal(folder / "a.journal", test::whole_record());
  test::write_content(folder / "a.journal",
                      with_a_flip(test::content_of(folder / "a.journal"), sizes[3] - 1));
  test::write_content(folder / "a.journal.damaged", "precious");
  const auto made = finalise(folder / "a.journal");
  ASSERT_TRUE(made) << made.error().message;
  const std::vector<std::string> names{"a.h5", "a.journal.2.damaged", "a.journal.damaged"};
  EXPECT_EQ(names_in(folder.path()), names);
  EXPECT_EQ(test::content_of(folder / "a.journal.damaged"), "precious");
  const auto again = finalise(made->kept);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->file, made->file);
  EXPECT_EQ(names_in(folder.path()), names);
}

// Tried again later it may give all; a copy without the sector can be recovered.
TEST(Finalise, WhatTheDiskDoesNotGiveIsNotDamaged) {
  const TemporaryFolder folder;
  const auto sizes = test::write_journal(folder / "a.journal", test::whole_record());
  test::LackingDisk disk;
  for (const int error : {EIO, ESTALE}) {
    disk.pread_error = error;
    for (const std::size_t from : {std::size_t{0}, sizes[2], sizes[3] - 1}) {
      disk.pread_from = static_cast<off_t>(from);
      const auto made = finalise(folder / "a.journal", {}, disk);
      ASSERT_FALSE(made);
      EXPECT_EQ(made.error().kind, base::ErrorKind::kFailure);
      EXPECT_THAT(made.error().message, testing::HasSubstr("a.journal: cannot be read at byte"));
      EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.journal"});
    }
  }
  disk.pread_error = 0;
  ASSERT_TRUE(finalise(folder / "a.journal", {}, disk));
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.h5"});
}

TEST(Finalise, ATornJournalStaysIfScansAreKnownToBeMissing) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::whole_record(), false);
  test::write_content(folder / "a.journal", test::content_of(folder / "a.journal") + "SSJ1torn!");
  const auto made = finalise(folder / "a.journal", {}, record::system_calls(), {}, 47);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->kept, folder / "a.journal.damaged");
  EXPECT_THAT(read_record(made->file)->end->reasons,
              testing::Contains("47 scans were written to the journal, 40 could be read"));
}

// A stop between the rename and the removal of the journal leaves both.
TEST(Finalise, JournalOfAPublishedRecordIsOnlyRemoved) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::sample_record());
  const std::string journal = test::content_of(folder / "a.journal");
  ASSERT_TRUE(finalise(folder / "a.journal"));
  const std::string published = test::content_of(folder / "a.h5");
  test::write_content(folder / "a.journal", journal);

  ASSERT_TRUE(finalise(folder / "a.journal"));

  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.h5"});
  EXPECT_EQ(test::content_of(folder / "a.h5"), published);
}

TEST(IsoTime, GoesThereAndBackExactly) {
  EXPECT_EQ(record::iso_time(1'795'265'582'123'456'789), "2026-11-21T12:53:02.123456789+00:00");
  for (const std::int64_t ns : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{951'782'400'000'000'001}}) {
    EXPECT_EQ(record::ns_from_iso_time(record::iso_time(ns)), ns);
  }
  for (const char* bad :
       {"", "2026-11-21", "2026-13-21T13:06:22.123456789+00:00", "2026-11-21T13:06:22.1+00:00",
        "2723-11-21T13:06:22.123456789+00:00", "0001-01-01T00:00:00.000000000+00:00"}) {
    EXPECT_FALSE(record::ns_from_iso_time(bad)) << bad;
  }
  // The ends of the range, by date -u -d @-9223372037 and @9223372036.
  EXPECT_EQ(record::iso_time(std::numeric_limits<std::int64_t>::min()),
            "1677-09-21T00:12:43.145224192+00:00");
  EXPECT_EQ(record::iso_time(std::numeric_limits<std::int64_t>::max()),
            "2262-04-11T23:47:16.854775807+00:00");
}

// --- Files that are no records -------------------------------------------------------------------

void expect_refusal(const base::Result<record::Record>& read, const fs::path& path,
                    const std::string& reason) {
  ASSERT_FALSE(read) << path;
  EXPECT_EQ(read.error().exit_status(), 2);
  EXPECT_THAT(read.error().message, HasSubstr(path.string()));
  EXPECT_THAT(read.error().message, HasSubstr(reason));
  EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
}

void expect_refused(const fs::path& path, const std::string& reason) {
  expect_refusal(read_record(path), path, reason);
  expect_refusal(record::read_without_scans(path), path, reason);
}

/// Damage in what read_without_scans() does not read.
void expect_whole_refused(const fs::path& path, const std::string& reason) {
  expect_refusal(read_record(path), path, reason);
  EXPECT_TRUE(record::read_without_scans(path));
}

TEST(HostileFile, ThatIsNoHdf5) {
  const TemporaryFolder folder;
  expect_refused(folder / "missing.h5", "no such file");
  expect_refused(folder.path(), "is a folder");
  test::write_content(folder / "empty.h5", "");
  expect_refused(folder / "empty.h5", "is no HDF5 file");
  test::write_content(folder / "text.h5", "t_s,F_over_mg\n1,2\n");
  expect_refused(folder / "text.h5", "is no HDF5 file");
}

// Cut everywhere: each is refused in one line, none crashes, none is taken for a record.
TEST(HostileFile, ThatIsCutShort) {
  const TemporaryFolder folder;
  ASSERT_TRUE(publish_record(test::sample_record(), folder / "a.h5"));
  const std::string whole = test::content_of(folder / "a.h5");
  ASSERT_GT(whole.size(), 10'000U);
  constexpr std::size_t kSignature = 8;
  for (std::size_t size = kSignature; size < whole.size(); size += 997) {
    test::write_content(folder / "cut.h5", whole.substr(0, size));
    const auto read = read_record(folder / "cut.h5");
    ASSERT_FALSE(read) << size;
    ASSERT_EQ(read.error().exit_status(), 2);
  }
  test::write_content(folder / "cut.h5", whole.substr(0, whole.size() / 2));
  expect_refused(folder / "cut.h5", "cut short or damaged");
}

/// A record in which `change` altered something through the bare library.
fs::path altered(const TemporaryFolder& folder, const std::function<void(hid_t)>& change) {
  static int number = 0;
  fs::path path = folder / ("altered" + std::to_string(number++) + ".h5");
  EXPECT_TRUE(publish_record(test::sample_record(), path));
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  EXPECT_GE(file, 0);
  change(file);
  EXPECT_GE(H5Fclose(file), 0);
  return path;
}

void replace_column(hid_t file, const char* path, hid_t type, hsize_t count) {
  ASSERT_GE(H5Ldelete(file, path, H5P_DEFAULT), 0);
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t dataset = H5Dcreate2(file, path, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(dataset, 0);
  H5Dclose(dataset);
  H5Sclose(space);
}

TEST(HostileFile, ThatIsHdf5ButNoRecord) {
  const TemporaryFolder folder;
  expect_refused(altered(folder, [](hid_t file) { H5Adelete(file, "format"); }), "no record of this program");
  expect_refused(altered(folder, [](hid_t file) { H5Ldelete(file, "entry", H5P_DEFAULT); }),
                 "group entry is missing");
}

// What is cited of a file would otherwise move the cursor of whoever reads the refusal.
TEST(HostileFile, ThatIsCitedInOneLine) {
  const TemporaryFolder folder;
  const fs::path path = altered(folder, [](hid_t file) {
    H5Ldelete(file, "entry/results/regime", H5P_DEFAULT);
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, 5);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t set =
        H5Dcreate2(file, "entry/results/regime", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, "a\n\x1b[m");
    H5Dclose(set);
    H5Sclose(space);
    H5Tclose(type);
  });
  expect_refused(path, "'a\\x0a\\x1b[m'");
  for (const auto& finding : record::judge(path).findings) {
    EXPECT_TRUE(std::ranges::none_of(finding.text, [](char c) { return c >= 0 && c < 0x20; }))
        << finding.text;
  }
}

TEST(HostileFile, WithOtherTypesOrShapes) {
  const TemporaryFolder folder;
  expect_refused(altered(folder, [](hid_t f) { H5Ldelete(f, "entry/raw/scan", H5P_DEFAULT); }),
                 "data set scan is missing");
  expect_whole_refused(
      altered(folder, [](hid_t f) { replace_column(f, "entry/raw/scan", H5T_IEEE_F64LE, 40); }),
      "scan has another type");
  expect_refused(altered(folder, [](hid_t f) { replace_column(f, "entry/raw/counts", H5T_STD_U16LE, 39); }),
                 "counts has 39 rows, not 40");
  expect_refused(altered(folder, [](hid_t f) { replace_column(f, "entry/raw/counts", H5T_C_S1, 40); }),
                 "counts has another type");
  expect_refused(altered(folder, [](hid_t f) { replace_column(f, "entry/process/status", H5T_C_S1, 1); }),
                 "status is no single value");
  expect_refused(
      altered(folder, [](hid_t f) { replace_column(f, "entry/raw/scan", H5T_STD_I64LE, hsize_t{1} << 50U); }),
      "has 1125899906842624 rows, at most");
  expect_refused(altered(folder, [](hid_t f) { H5Ldelete(f, "entry/results/mu_s", H5P_DEFAULT); }),
                 "data set mu_s is missing");
  expect_refused(altered(folder,
                         [](hid_t f) {
                           H5Ldelete(f, "entry/results/rung", H5P_DEFAULT);
                           H5Lcreate_hard(f, "entry/results/regime", f, "entry/results/rung", H5P_DEFAULT,
                                          H5P_DEFAULT);
                         }),
                 "results/rung 'mixed' is unknown");
}

TEST(HostileFile, LargerThanTheMemoryIsNotCalledDamaged) {
  if (base::kSanitized) GTEST_SKIP() << "a sanitizer maps terabytes: no limit";
  const TemporaryFolder folder;
  const fs::path path = altered(folder, [](hid_t f) {
    replace_column(f, "entry/raw/scan", H5T_STD_I64LE, hsize_t{1} << 28U);
    replace_column(f, "entry/raw/counts", H5T_STD_U16LE, hsize_t{1} << 28U);
  });
  const auto read_with_little = [&] {
    const rlimit little{1U << 30U, 1U << 30U};  // Half of what the column takes.
    ::setrlimit(RLIMIT_AS, &little);
    const auto read = read_record(path);
    std::fputs(read ? "read" : read.error().message.c_str(), stderr);
    std::_Exit(read ? 0 : read.error().exit_status());
  };
  EXPECT_EXIT(read_with_little(), testing::ExitedWithCode(1), "there is no memory left");
}

TEST(HostileFile, WithAlteredValues) {
  const TemporaryFolder folder;
  // 40 zeros where other counts were: type and shape fit, the checksum does not.
  expect_refused(altered(folder, [](hid_t f) { replace_column(f, "entry/raw/counts", H5T_STD_U16LE, 40); }),
                 "do not match process/sha256");
  expect_whole_refused(
      altered(folder, [](hid_t f) { replace_column(f, "entry/raw/scan", H5T_STD_I64LE, 40); }),
      "scan does not rise");
}

}  // namespace
}  // namespace stickslip

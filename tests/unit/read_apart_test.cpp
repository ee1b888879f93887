// Files read in a child: what it may take, what becomes of it, and that nothing is lost on the way.

#include "core/record/read_apart.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>

#include "core/base/regular_file.hpp"
#include "core/base/sanitized.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/reader.hpp"
#include "tests/support/record_equality.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::record {
namespace {

using base::ErrorKind;
using base::LimitedChild;
using base::WorkLimits;
using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr WorkLimits kEnough{milliseconds{10'000}, 512'000'000};
constexpr WorkLimits kLittle{milliseconds{20}, 20'000'000};

std::string do_as_told(std::string_view question, int memory_file) {
  if (question == "write") return std::to_string(::pwrite(memory_file, "x", 1, 1 << 20));
  if (question == "spin") {
    for (std::atomic<int> turns{0};;) ++turns;
  }
  if (question == "long") return std::string(1'000'000, 'a');
  if (question == "die") static_cast<void>(std::raise(SIGKILL));
  if (question == "throw") throw std::runtime_error("x");
  if (question == "grow") {
    std::vector<char> much(200'000'000, 'x');
    return std::string{much.back()};
  }
  return std::to_string(::getpid());
}

TEST(LimitedChildTest, OneChildAnswersManyQuestions) {
  LimitedChild child{do_as_told};
  const auto first = child.ask("who", kLittle);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_NE(*first, std::to_string(::getpid()));
  // Each has an allowance of its own, or the last of so many would go over it.
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(child.ask("who", kLittle).value(), *first);
  EXPECT_EQ(child.ask("long", kLittle).value().size(), 1'000'000U);
}

TEST(LimitedChildTest, IsReplacedWhenItDies) {
  LimitedChild child{do_as_told};
  const std::string first = child.ask("who", kEnough).value();
  const auto died = child.ask("die", kEnough);
  ASSERT_FALSE(died);
  EXPECT_EQ(died.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(died.error().message, HasSubstr("ended by signal 9"));
  EXPECT_FALSE(child.ask("throw", kEnough));
  EXPECT_NE(child.ask("who", kEnough).value(), first);
}

TEST(LimitedChildTest, KilledBetweenTwoQuestionsIsReplacedUnnoticed) {
  LimitedChild child{do_as_told};
  const std::string first = child.ask("who", kEnough).value();
  ::kill(std::atoi(first.c_str()), SIGKILL);
  // The second question at the latest finds that it has gone.
  const auto next = child.ask("who", kEnough);
  EXPECT_NE(child.ask("who", kEnough).value(), first);
  static_cast<void>(next);
}

TEST(LimitedChildTest, ThatTakesTooLongIsEndedAndSaysTheLimit) {
  LimitedChild child{do_as_told};
  const auto spun = child.ask("spin", kLittle);
  ASSERT_FALSE(spun);
  EXPECT_EQ(spun.error().message,
            "cannot be read in 0.02 s of processor time, which is the limit for its size");
  EXPECT_TRUE(child.ask("who", kLittle));
}

TEST(LimitedChildTest, ThatTakesTooMuchMemoryIsEndedAndSaysTheLimit) {
  if (base::kSanitized) GTEST_SKIP() << "a sanitizer maps terabytes: no limit";
  LimitedChild child{do_as_told};
  const auto grown = child.ask("grow", {milliseconds{10'000}, 20'000'000});
  ASSERT_FALSE(grown);
  EXPECT_EQ(grown.error().message, "cannot be read in 20 MB of memory, which is the limit for its size");
  EXPECT_EQ(child.ask("grow", kEnough).value(), "x");
}

// As of a program whose output is limited: the daemon's child that makes a report, and reads records.
TEST(LimitedChildTest, WritesMoreThanItsParentMay) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit little{1 << 16, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &little), 0);
  LimitedChild child{do_as_told};
  const auto written = child.ask("write", kEnough);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(written.value(), "1");
}

TEST(LimitedChildTest, IsGivenUpWhenAskedTo) {
  LimitedChild child{do_as_told};
  const auto stopped = child.ask("spin", kEnough, [] { return true; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
  EXPECT_TRUE(child.ask("who", kEnough));
}

TEST(LimitedChildTest, ThisProcessWorksMeanwhile) {
  LimitedChild child{do_as_told};
  ASSERT_TRUE(child.begin("long", kEnough));
  EXPECT_EQ(child.answer().value().size(), 1'000'000U);
  // An answer that nobody took is not that to the next question.
  ASSERT_TRUE(child.begin("long", kEnough));
  EXPECT_LT(child.ask("who", kEnough).value().size(), 20U);
  ASSERT_TRUE(child.begin("spin", kLittle));
  EXPECT_THAT(child.answer().error().message, HasSubstr("0.02 s of processor time"));
}

TEST(LimitedChildTest, LimitsGrowWithTheFile) {
  EXPECT_EQ(base::limits_for_file(0).processor_time, milliseconds{10'000});
  EXPECT_EQ(base::limits_for_file(3'000'000).processor_time, milliseconds{13'000});
  EXPECT_EQ(base::limits_for_file(0).memory, 512'000'000U);
  EXPECT_EQ(base::limits_for_file(3'000'000).memory, 572'000'000U);
}

// A child that a malicious file has taken over may claim any size.
TEST(LimitedChildTest, AnAnswerLongerThanTheLimitIsRefusedBeforeRoomIsMadeForIt) {
  for (const char* claim : {R"(printf '\377\377\377\377\377\377\377\177' >&0; exec sleep 60)",
                            R"(printf '\001\312\232\073\000\000\000\000' >&0; exec sleep 60)"}) {
    LimitedChild child{base::ChildProgram{"/bin/sh", {"-c", claim}}};
    const auto claimed = child.ask("how much", kEnough);
    ASSERT_FALSE(claimed);
    EXPECT_EQ(claimed.error().kind, ErrorKind::kUsage);
    EXPECT_TRUE(claimed.error().worker_died);
    EXPECT_THAT(claimed.error().message, HasSubstr("bytes, at most 1000000000 are taken"));
  }
}

TEST(ReadApart, GivesEveryFieldToTheLastBit) {
  const test::TemporaryFolder folder;
  ApartReader reader{LimitedChild{read_for_parent}};
  int number = 0;
  for (const Record& sample : {test::sample_record(), test::whole_record()}) {
    const auto path = folder / (std::to_string(++number) + ".h5");
    ASSERT_TRUE(publish_record(sample, path));
    const auto here = read_record(path);
    ASSERT_TRUE(here) << here.error().message;
    const auto apart = reader.read(path, kEnough);
    ASSERT_TRUE(apart) << apart.error().message;
    test::expect_same_record(*here, *apart);
    EXPECT_EQ(here->sha256, apart->sha256);
  }
}

Record without_scans(Record record) {
  record.scan.clear();
  record.raw.clear();
  record.true_coefficient.clear();
  record.second.clear();
  record.spikes.clear();
  record.gaps.clear();
  record.events.clear();
  return record;
}

TEST(ReadApart, FactsAreThoseOfTheWholeRecord) {
  const test::TemporaryFolder folder;
  const auto path = folder / "1.h5";
  ASSERT_TRUE(publish_record(test::whole_record(), path));
  Record expected = without_scans(read_record(path).value());
  expected.cycles.clear();
  expected.end->truth.reset();
  ApartReader reader{LimitedChild{read_facts_for_parent}};
  for (const auto& facts : {read_facts(path), reader.read(path, kEnough)}) {
    ASSERT_TRUE(facts) << facts.error().message;
    test::expect_same_record(*facts, expected);
  }
}

TEST(ReadApart, FactsOfCountsWithoutAGainAreAnErrorThatNamesTheGain) {
  const test::TemporaryFolder folder;
  const auto path = folder / "1.h5";
  ASSERT_TRUE(publish_record(test::whole_record(), path));
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Ldelete(file, "entry/instrument/calibration/gain", H5P_DEFAULT), 0);
  H5Fclose(file);
  ApartReader reader{LimitedChild{read_facts_for_parent}};
  for (const auto& facts : {read_facts(path), reader.read(path, kEnough)}) {
    ASSERT_FALSE(facts);
    EXPECT_EQ(facts.error().kind, ErrorKind::kUsage);
    EXPECT_FALSE(facts.error().worker_died);
    EXPECT_EQ(facts.error().message,
              path.string() +
                  ": instrument/calibration/gain is missing, counts mean nothing without: take "
                  "the record from a backup");
  }
}

TEST(ReadApart, ResultsAreThoseOfTheWholeRecordWithoutItsScans) {
  for (const Record& sample : {test::whole_record(), test::sample_imported()}) {
    const test::TemporaryFolder folder;
    const auto path = folder / "1.h5";
    ASSERT_TRUE(publish_record(sample, path));
    Record expected = without_scans(read_record(path).value());
    if (expected.end->truth) {
      expected.end->truth->modes.clear();
      expected.end->truth->cycles.clear();
    }
    ASSERT_EQ(expected.cycles.size(), sample.cycles.size());
    const auto work = [](std::string_view file, int memory_file) {
      return read_results_for_parent(file, {}, memory_file);
    };
    ApartReader reader{LimitedChild{work}};
    for (const auto& results : {read_results_apart(path), reader.read(path, kEnough)}) {
      ASSERT_TRUE(results) << results.error().message;
      test::expect_same_record(*results, expected);
      EXPECT_EQ(results->sha256, expected.sha256);
    }
  }
}

TEST(ReadApart, OfTheResultsThoseThatAreNamedAreRead) {
  const test::TemporaryFolder folder;
  const auto path = folder / "1.h5";
  ASSERT_TRUE(publish_record(test::whole_record(), path));
  const auto whole = read_record(path);
  ASSERT_TRUE(whole) << whole.error().message;
  const std::vector<std::string> only{"mu_s", "omega"};
  const auto read = read_results_apart(path, only);
  ASSERT_TRUE(read) << read.error().message;
  const auto expected = [&] {
    analysis::TestResults results = whole->end->results;
    analysis::for_each_result(results, [&](const analysis::ResultName& name, analysis::Estimate& estimate) {
      if (std::ranges::find(only, name.name) == only.end()) estimate = analysis::Estimate::none("not read");
    });
    return results;
  }();
  EXPECT_EQ(read->end->results, expected);
}

TEST(ReadApart, InTurnGivesTheNamedFileOfAListUpToTheLast) {
  const test::TemporaryFolder folder;
  const std::array<std::string, 2> files{folder / "1.h5", folder / "2.h5"};
  ASSERT_TRUE(publish_record(test::sample_record(), files[0]));
  ASSERT_TRUE(publish_record(test::whole_record(), files[1]));
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto here = read_record(files[i]);
    ASSERT_TRUE(here) << here.error().message;
    const auto in_turn = read_record_in_turn(files, i);
    ASSERT_TRUE(in_turn) << in_turn.error().message;
    test::expect_same_record(*here, *in_turn);
  }
}

TEST(ReadApart, SaysWhatTheReaderSays) {
  const test::TemporaryFolder folder;
  test::write_content(folder / "text.h5", "t_s,F_over_mg\n1,2\n");
  ApartReader reader{LimitedChild{read_for_parent}};
  for (const auto& path : {folder / "text.h5", folder / "absent.h5"}) {
    const auto apart = reader.read(path, kEnough);
    ASSERT_FALSE(apart);
    EXPECT_EQ(apart.error().message, read_record(path).error().message);
    EXPECT_EQ(apart.error().kind, read_record(path).error().kind);
  }
}

TEST(ReadApart, AnEmptyPathIsNoFile) {
  const auto read_nothing = [] {
    read_records_apart();
    const auto read = read_record_apart("");
    std::_Exit(read ? 0 : read.error().exit_status());
  };
  EXPECT_EXIT(read_nothing(), testing::ExitedWithCode(2), "");
}

TEST(ReadApart, OfWhatDoesNotComeBackNamesFileLimitAndRemedy) {
  ApartReader reader{LimitedChild{do_as_told}};
  const auto spun = reader.read("spin", kLittle);
  ASSERT_FALSE(spun);
  EXPECT_EQ(
      spun.error().message,
      "spin: cannot be read in 0.02 s of processor time, which is the limit for its size; `stickslip verify "
      "spin` says what is damaged; take it from a backup");
}

TEST(RegularFile, AnythingElseIsNamedAndNotWaitedFor) {
  const test::TemporaryFolder folder;
  const auto fifo = folder / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(base::open_regular(fifo).error().message, fifo.string() + ": is a FIFO, not a regular file");
  EXPECT_EQ(base::read_text(fifo).error().message, fifo.string() + ": is a FIFO, not a regular file");
  EXPECT_EQ(base::read_text("/dev/zero").error().message, "/dev/zero: is a device, not a regular file");
  EXPECT_THAT(base::read_text(folder.path()).error().message, HasSubstr("is a folder"));
  EXPECT_THAT(read_record(fifo).error().message, HasSubstr("is a FIFO"));
}

TEST(RegularFile, WhatThisProcessWasGivenOpenIsReadAsAText) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  ASSERT_EQ(::write(ends[1], "a\nb\n", 4), 4);
  ::close(ends[1]);
  const std::string name = "/dev/fd/" + std::to_string(ends[0]);
  EXPECT_FALSE(base::open_regular(name));
  EXPECT_EQ(base::read_text(name).value(), "a\nb\n");
  ::close(ends[0]);
}

}  // namespace
}  // namespace stickslip::record

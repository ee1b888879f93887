#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/sanitized.hpp"
#include "core/record/fields.hpp"
#include "core/record/journal.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/json_fields.hpp"
#include "core/record/range_check.hpp"
#include "tests/support/journal_samples.hpp"
#include "tests/support/record_equality.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

using record::JournalWriter;
using record::read_journal;
using test::TemporaryFolder;
using testing::HasSubstr;

TEST(Journal, GivesBackEveryFieldOfEveryEntry) {
  const TemporaryFolder folder;
  const record::Record written = test::sample_record();
  test::write_journal(folder / "a.journal", written);

  const auto read = read_journal(folder / "a.journal");

  ASSERT_TRUE(read) << read.error().message;
  test::expect_same_record(read->record, written);
  EXPECT_EQ(read->why_unread(), "");
}

TEST(Journal, GivesBackImportedValuesToTheLastBit) {
  const TemporaryFolder folder;
  const record::Record written = test::sample_imported();
  test::write_journal(folder / "a.journal", written);
  const auto read = read_journal(folder / "a.journal");
  ASSERT_TRUE(read) << read.error().message;
  test::expect_same_record(read->record, written);
}

TEST(Journal, KeepsCountsThatNeed32Bits) {
  const TemporaryFolder folder;
  record::Record written = test::sample_record();
  written.header.board.maxdata = 0xFFFF'FFFF;
  written.raw[1] = 4294967295.0;
  test::write_journal(folder / "a.journal", written);
  const auto read = read_journal(folder / "a.journal");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->record.raw, written.raw);
}

// Whatever byte a crash cuts at, what was whole before is kept and nothing else appears.
TEST(Journal, CutAnywhereKeepsEveryWholeEntry) {
  const TemporaryFolder folder;
  const auto sizes = test::write_journal(folder / "a.journal", test::sample_record());
  const std::string whole = test::content_of(folder / "a.journal");
  ASSERT_EQ(sizes.back(), whole.size());

  // Cut shorter and shorter: rewriting the file for each size would wait for the disk each time.
  constexpr std::size_t kStep = base::kSanitized ? 7 : 1;
  for (std::size_t size = whole.size(); size >= kStep;) {
    size -= kStep;
    std::filesystem::resize_file(folder / "a.journal", size);
    const auto entries =
        static_cast<std::size_t>(std::upper_bound(sizes.begin(), sizes.end(), size) - sizes.begin());
    const auto read = read_journal(folder / "a.journal");
    if (entries == 0) {
      ASSERT_FALSE(read) << size;
      EXPECT_EQ(read.error().exit_status(), 2);
      continue;
    }
    ASSERT_TRUE(read) << size << ": " << read.error().message;
    ASSERT_TRUE(read->damaged.empty()) << size;
    ASSERT_EQ(read->torn_end.has_value(), sizes[entries - 1] != size) << size;
    ASSERT_EQ(read->torn_end ? read->torn_end->first : size, sizes[entries - 1]) << size;
    ASSERT_FALSE(read->record.end.has_value());
  }
}

TEST(Journal, TrueForceKeepsItsRowsWhereverItStandsAndWhateverIsMissing) {
  const TemporaryFolder folder;
  const record::Record sample = test::sample_record();
  {
    auto journal = JournalWriter::create(folder / "a.journal", sample.header);
    ASSERT_TRUE(journal);
    const std::vector<double> raw(10, 5.0);
    ASSERT_TRUE(journal->append_scans(100, raw, {}));
    ASSERT_TRUE(journal->append_scans(110, raw, {}));
    ASSERT_TRUE(journal->append_scans(200, raw, {}));
    const std::vector<double> force{0.1, 0.2, 0.3};
    ASSERT_TRUE(journal->append_true_coefficients(109, force));  // Over the border of two entries.
    ASSERT_TRUE(journal->append_true_coefficients(207, force));
  }
  const auto read = read_journal(folder / "a.journal");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->why_unread(), "");
  ASSERT_EQ(read->record.true_coefficient.size(), 30U);
  for (std::size_t row = 0; row < 30; ++row) {
    const double value = read->record.true_coefficient[row];
    const double expected = row >= 9 && row < 12    ? 0.1 * static_cast<double>(row - 8)
                            : row >= 27 && row < 30 ? 0.1 * static_cast<double>(row - 26)
                                                    : std::nan("");
    if (std::isnan(expected)) {
      EXPECT_TRUE(std::isnan(value)) << row;
    } else {
      EXPECT_DOUBLE_EQ(value, expected) << row;
    }
  }
  // Straight from the disk it is the same.
  const auto counted = read_journal(folder / "a.journal", record::JournalScans::kCount);
  ASSERT_TRUE(counted);
  EXPECT_TRUE(counted->record.raw.empty());
  const record::JournalScanSource source{folder / "a.journal", *counted};
  EXPECT_EQ(source.size(), 30U);
  EXPECT_EQ(source.extent(), 110);
  std::size_t rows = 0;
  source.for_each_force_piece([&](std::span<const double> force) {
    for (const double value : force) {
      test::expect_same_bits(value, read->record.true_coefficient[rows++], "true force");
    }
  });
  EXPECT_EQ(rows, 30U);
}

TEST(Journal, TrueForceOfScansThatAreNotThereIsLeftOut) {
  const TemporaryFolder folder;
  {
    auto journal = JournalWriter::create(folder / "a.journal", test::sample_header());
    ASSERT_TRUE(journal);
    ASSERT_TRUE(journal->append_scans(100, std::vector<double>(10, 5.0), {}));
    ASSERT_TRUE(journal->append_true_coefficients(105, std::vector<double>(6, 0.3)));
    ASSERT_TRUE(journal->append_true_coefficients(200, std::vector<double>(6, 0.3)));
  }
  const auto read = read_journal(folder / "a.journal");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->why_unread(), "values of scans that are not there");
  ASSERT_EQ(read->record.true_coefficient.size(), 10U);
  for (std::size_t row = 0; row < 10; ++row)
    EXPECT_EQ(std::isnan(read->record.true_coefficient[row]), row < 5) << row;
}

// What a program killed between the two entries of the same scans leaves behind.
TEST(Journal, ScansWhoseSecondChannelDidNotArriveAreKeptWithoutIt) {
  const TemporaryFolder folder;
  {
    auto journal = JournalWriter::create(folder / "a.journal", test::sample_header());
    ASSERT_TRUE(journal);
    ASSERT_TRUE(journal->append_scans(100, std::vector<double>(3, 5.0), {}));
    ASSERT_TRUE(journal->append_second(100, std::vector<std::int32_t>{7, 8, 9}));
    ASSERT_TRUE(journal->append_scans(103, std::vector<double>(2, 5.0), {}));
  }
  const auto read = read_journal(folder / "a.journal");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->why_unread(), "");
  EXPECT_EQ(read->record.second, (std::vector<std::int32_t>{7, 8, 9, -1, -1}));
  const record::JournalScanSource source{folder / "a.journal", *read};
  std::vector<std::int32_t> straight;
  source.for_each_second_piece([&](std::span<const std::int32_t> piece) {
    straight.insert(straight.end(), piece.begin(), piece.end());
  });
  EXPECT_EQ(straight, read->record.second);
}

TEST(Journal, ImpossibleCodesOfTheSecondChannelAreSkipped) {
  for (const std::int32_t code : {4096, -2}) {
    const TemporaryFolder folder;
    {
      auto journal = JournalWriter::create(folder / "a.journal", test::sample_header());
      ASSERT_TRUE(journal);
      ASSERT_TRUE(journal->append_scans(100, std::vector<double>(1, 5.0), {}));
      ASSERT_TRUE(journal->append_second(100, std::vector<std::int32_t>{code}));
    }
    const auto read = read_journal(folder / "a.journal");
    ASSERT_TRUE(read);
    EXPECT_EQ(read->why_unread(), "code of the second channel out of range");
    EXPECT_EQ(read->record.raw.size(), 1U);
  }
}

// A clock that ran backwards through zero made the difference of two readings overflow.
TEST(Journal, ScansAndClocksThatCannotBeAreSkipped) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  using Write = std::function<base::Result<void>(JournalWriter&)>;
  const std::vector<std::pair<Write, std::string>> cases{
      {[](JournalWriter& file) { return file.append_scans(kMost - 3, std::vector<double>(3, 5.0), {}); },
       "scan 9223372036854775804 lies outside of 0 to 9007199254740992"},
      {[](JournalWriter& file) {
         return file.append_scans(record::kLastScan - 1, std::vector<double>(3, 5.0), {});
       },
       "scan 9007199254740993 lies outside of 0 to 9007199254740992"},
      {[](JournalWriter& file) {
         return file.append_anchor({kLeast, 1, 1});
       },
       "scan -9223372036854775808 lies outside of 0 to 9007199254740992"},
      {[](JournalWriter& file) {
         return file.append_anchor({100, kLeast, 1});
       },
       "no clock shows -9223372036854775808 ns and 1 ns: below zero"},
      {[](JournalWriter& file) {
         return file.append_anchor({100, 1, -5});
       },
       "no clock shows 1 ns and -5 ns: below zero"},
      {[](JournalWriter& file) {
         return file.append_gap({100, kMost, false, daq::GapCause::kOverrun});
       },
       "a gap of 9223372036854775807 scans from scan 100 ends outside of 0 to 9007199254740992"},
      {[](JournalWriter& file) {
         return file.append_gap({100, -1, false, daq::GapCause::kOverrun});
       },
       "a gap of -1 scans from scan 100 ends outside of 0 to 9007199254740992"},
      {[](JournalWriter& file) {
         return file.append_event({-7, 1, "lost"});
       },
       "scan -7 lies outside of 0 to 9007199254740992"}};
  for (const auto& [write, words] : cases) {
    const TemporaryFolder folder;
    {
      auto journal = JournalWriter::create(folder / "a.journal", test::sample_header());
      ASSERT_TRUE(journal);
      ASSERT_TRUE(journal->append_scans(100, std::vector<double>(1, 5.0), {}));
      ASSERT_TRUE(write(*journal));
    }
    const auto read = read_journal(folder / "a.journal");
    ASSERT_TRUE(read);
    EXPECT_EQ(read->why_unread(), words);
    EXPECT_EQ(read->record.raw.size(), 1U) << words;
  }
}

TEST(Journal, NumbersOfTheEndThatFitNoColumnAreRefused) {
  record::EndRecord end = *test::sample_record().end;
  end.truth.reset();
  end.cycles.clear();
  end.cycles.push_back(test::sample_record().cycles[0]);
  std::vector<std::byte> bytes;
  record::append_end_bytes(end, bytes);
  const auto tables = std::ranges::find(bytes, std::byte{0}) + 1 - bytes.begin();
  std::ptrdiff_t column = 0;
  record::for_each_cycle_column([&](const record::FieldName& name, auto member) {
    using Number = std::decay_t<decltype(detect::Cycle{}.*member)>;
    std::vector<std::byte> changed = bytes;
    const double huge = 1e300;
    std::memcpy(changed.data() + tables + column++ * static_cast<std::ptrdiff_t>(sizeof huge), &huge,
                sizeof huge);
    if constexpr (std::is_integral_v<Number>) {
      EXPECT_THROW(static_cast<void>(record::end_from_bytes(changed)), std::invalid_argument) << name.name;
    } else {
      EXPECT_EQ(record::end_from_bytes(changed).cycles[0].*member, huge) << name.name;
    }
  });
  EXPECT_EQ(tables + column * static_cast<std::ptrdiff_t>(sizeof(double)), std::ssize(bytes));
}

/// The payload of an end whose JSON says `now` instead of `then`, and whose tables have `more` numbers behind
/// them.
std::vector<std::byte> end_of_newer_program(const record::EndRecord& end, std::string_view then,
                                            std::string_view now, std::span<const double> more) {
  std::vector<std::byte> bytes;
  record::append_end_bytes(end, bytes);
  std::string text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  EXPECT_NE(text.find(then), std::string::npos);
  text.replace(text.find(then), then.size(), now);
  text.append(reinterpret_cast<const char*>(more.data()), more.size_bytes());
  const auto changed = std::as_bytes(std::span{text});
  return {changed.begin(), changed.end()};
}

TEST(Journal, ColumnsOfCyclesThatANewerProgramAppendedAreSkipped) {
  record::EndRecord end = *test::sample_record().end;
  end.truth.reset();
  end.cycles.clear();
  // The newer column of the first row is the first number of the second: as many columns, one row less.
  end.cycles.push_back(test::sample_record().cycles[0]);
  const detect::Cycle written = std::as_const(end).cycles[0];
  const std::size_t columns = record::cycle_columns();
  std::vector<double> more{7.0};
  std::vector<std::byte> row;
  record::append_end_bytes(end, row);
  const std::size_t tables = row.size() - columns * sizeof(double);
  more.resize(1 + columns + 1, 7.0);
  std::memcpy(&more[1], row.data() + tables, columns * sizeof(double));
  std::string then = fmt::format(R"("cycle_columns":{},"cycle_count":1)", columns);
  std::string now = fmt::format(R"("cycle_columns":{},"cycle_count":2)", columns + 1);
  const auto read = record::end_from_bytes(end_of_newer_program(end, then, now, more));
  ASSERT_EQ(read.cycles.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    record::for_each_cycle_column([&](const record::FieldName& name, auto member) {
      const auto value = static_cast<double>(std::as_const(read).cycles[i].*member);
      const auto expected = static_cast<double>(written.*member);
      EXPECT_EQ(std::memcmp(&value, &expected, sizeof value), 0) << name.name;
    });
  }
}

TEST(Journal, NumbersBehindTheKnownTablesAreNotTakenForOthers) {
  const record::EndRecord end = *test::sample_record().end;
  try {
    static_cast<void>(
        record::end_from_bytes(end_of_newer_program(end, "", "", std::vector<double>{1.0, 2.0})));
    ADD_FAILURE() << "was read";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "tables have 2 numbers more than this program knows: read it with the version that wrote it");
  }
}

TEST(Journal, OnlyTheWordsForInfinityAreNumbers) {
  double value = 0.0;
  record::decode(record::Json("-inf"), value);
  EXPECT_EQ(value, -std::numeric_limits<double>::infinity());
  record::decode(record::Json("inf"), value);
  EXPECT_EQ(value, std::numeric_limits<double>::infinity());
  EXPECT_THROW(record::decode(record::Json("abc"), value), std::invalid_argument);
}

TEST(Journal, WholeNumbersAreOfTheirType) {
  std::int64_t wide = 0;
  record::decode(record::Json(-7), wide);
  EXPECT_EQ(wide, -7);
  std::uint32_t narrow = 0;
  record::decode(record::Json(4294967295U), narrow);
  EXPECT_EQ(narrow, 4294967295U);
  for (const record::Json& other : {record::Json(2.5), record::Json(1e300), record::Json("2"),
                                    record::Json(nullptr), record::Json(UINT64_MAX)})
    EXPECT_THROW(record::decode(other, wide), std::exception) << other;
  for (const record::Json& other : {record::Json(-1), record::Json(4294967296)})
    EXPECT_THROW(record::decode(other, narrow), std::exception) << other;
  std::vector<double> column{1.0};
  EXPECT_THROW(record::decode(record::Json(nullptr), column), std::exception);
}

// CRC-32C finds every single-bit error: no flip anywhere may go unnoticed.
TEST(Journal, AnyFlippedBitCostsItsEntryAndNoOther) {
  const TemporaryFolder folder;
  const auto sizes = test::write_journal(folder / "a.journal", test::sample_imported());
  const std::string whole = test::content_of(folder / "a.journal");

  std::fstream file{folder / "a.journal", std::ios::binary | std::ios::in | std::ios::out};
  const auto put = [&](std::size_t at, char value) {
    file.seekp(static_cast<std::streamoff>(at)).put(value).flush();
  };
  for (std::size_t at = 0; at < whole.size(); ++at) {
    put(at, static_cast<char>(whole[at] ^ (1 << (at % 8))));
    const auto read = read_journal(folder / "a.journal");
    put(at, whole[at]);
    if (at < sizes.front()) {
      ASSERT_FALSE(read) << at;
      ASSERT_EQ(read.error().exit_status(), 1) << at;
      continue;
    }
    const auto entry_end = std::upper_bound(sizes.begin(), sizes.end(), at);
    ASSERT_TRUE(read) << at;
    // A size that has become larger makes the last entry look torn.
    ASSERT_EQ(read->damaged.size() + (read->torn_end ? 1 : 0), 1U) << at;
    const record::UnreadBytes& lost = read->torn_end ? *read->torn_end : read->damaged.front();
    ASSERT_EQ(lost.first, *(entry_end - 1)) << at;
    ASSERT_EQ(lost.first + lost.size, *entry_end) << at;
    ASSERT_TRUE(!read->torn_end || *entry_end == whole.size()) << at;
  }
}

/// The entries of a journal, the header first.
std::vector<std::string> entries_of(const std::string& content, const std::vector<std::uint64_t>& ends) {
  std::vector<std::string> entries;
  std::uint64_t begin = 0;
  for (const std::uint64_t end : ends) {
    entries.push_back(content.substr(begin, end - begin));
    begin = end;
  }
  return entries;
}

/// Scans 100 … 109, 110 … 119 and 120 … 129, then an event.
std::vector<std::string> some_entries(const TemporaryFolder& folder) {
  std::vector<std::uint64_t> ends;
  {
    auto journal = JournalWriter::create(folder / "some.journal", test::sample_header());
    EXPECT_TRUE(journal);
    ends.push_back(journal->size());
    for (const daq::ScanIndex first : {100, 110, 120}) {
      EXPECT_TRUE(journal->append_scans(first, std::vector<double>(10, static_cast<double>(first)), {}));
      ends.push_back(journal->size());
    }
    EXPECT_TRUE(journal->append_event({125, 1, "a word"}));
    ends.push_back(journal->size());
  }
  return entries_of(test::content_of(folder / "some.journal"), ends);
}

std::string flipped(std::string entry) {
  entry.back() = static_cast<char>(entry.back() ^ 1);
  return entry;
}

TEST(Journal, ADamagedEntryIsAGapOnlyIfItHeldScans) {
  const TemporaryFolder folder;
  const auto entries = some_entries(folder);
  test::write_content(folder / "a.journal",
                      entries[0] + entries[1] + flipped(entries[2]) + flipped(entries[4]) + entries[3]);
  const auto read = read_journal(folder / "a.journal");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->scan_count, 20U);
  EXPECT_EQ(read->record.scan.back(), 129);
  ASSERT_EQ(read->record.gaps.size(), 1U);
  EXPECT_EQ(read->record.gaps[0].first, 110);
  EXPECT_EQ(read->record.gaps[0].count, 10);
  EXPECT_EQ(read->record.gaps[0].cause, daq::GapCause::kDamaged);
  ASSERT_EQ(read->damaged.size(), 1U);
  EXPECT_EQ(read->damaged[0].first, entries[0].size() + entries[1].size());
  EXPECT_EQ(read->damaged_size(), entries[2].size() + entries[4].size());
  EXPECT_EQ(read->why_unread(), "entry with a wrong checksum");

  test::write_content(folder / "b.journal", entries[0] + entries[1] + flipped(entries[4]) + entries[2]);
  const auto without_gap = read_journal(folder / "b.journal");
  ASSERT_TRUE(without_gap);
  EXPECT_TRUE(without_gap->record.gaps.empty());
  EXPECT_EQ(without_gap->damaged_size(), entries[4].size());
}

// As a disk that swaps pages leaves them.
TEST(Journal, ScansRiseWhereverTheirEntriesStand) {
  const TemporaryFolder folder;
  const auto entries = some_entries(folder);
  test::write_content(folder / "a.journal",
                      entries[3] + entries[4] + entries[0] + entries[2] + entries[1] + entries[2]);
  const auto read = read_journal(folder / "a.journal");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->record.scan.size(), 30U);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_EQ(read->record.scan[i], static_cast<daq::ScanIndex>(100 + i));
    EXPECT_EQ(read->record.raw[i], static_cast<double>(100 + i / 10 * 10));
  }
  EXPECT_TRUE(read->record.gaps.empty());
  EXPECT_EQ(read->damaged_size(), entries[2].size());
  EXPECT_EQ(read->why_unread(), "scans that stand there already");
}

TEST(Journal, OnlyAnEndThatAStopCanLeaveIsTorn) {
  const TemporaryFolder folder;
  const auto entries = some_entries(folder);
  std::string whole = entries[0];
  // The last entry begins in one sector and has half of it and more in another: its last byte is a zero
  // anyway.
  constexpr std::size_t kSector = 512;
  while (whole.size() % kSector <= kSector - entries[1].size() / 2) whole += entries[4];
  const std::string last = entries[1];
  const std::size_t border = kSector - whole.size() % kSector;
  ASSERT_LE(border, last.size() / 2);
  const auto torn = [&](const std::string& end) {
    test::write_content(folder / "a.journal", whole + end);
    const auto read = read_journal(folder / "a.journal");
    EXPECT_TRUE(read);
    EXPECT_EQ(read->damaged.size() + (read->torn_end ? 1 : 0), 1U);
    return read->torn_end.has_value();
  };
  EXPECT_TRUE(torn(last.substr(0, 3)));
  EXPECT_TRUE(torn(last.substr(0, last.size() - 1)));
  EXPECT_TRUE(torn(std::string(1000, '\0')));
  EXPECT_TRUE(torn(last.substr(0, border) + std::string(700, '\0')));
  const std::size_t behind = last.find_first_not_of('\0', border) + 1;
  ASSERT_LT(behind, last.size());
  EXPECT_FALSE(torn(last.substr(0, behind) + std::string(last.size() - behind, '\0')));
  EXPECT_FALSE(torn(flipped(last)));
  EXPECT_FALSE(torn("xyz"));
}

TEST(Journal, IsNeverStartedOverAnother) {
  const TemporaryFolder folder;
  test::write_content(folder / "a.journal", "precious");
  const auto journal = JournalWriter::create(folder / "a.journal", test::sample_header());
  ASSERT_FALSE(journal);
  EXPECT_THAT(journal.error().message, HasSubstr("a.journal: cannot be created: File exists"));
  EXPECT_EQ(test::content_of(folder / "a.journal"), "precious");
}

TEST(Journal, MakesAUuidWhereThereIsNone) {
  const TemporaryFolder folder;
  record::RecordHeader header = test::sample_header();
  header.uuid.clear();
  ASSERT_TRUE(JournalWriter::create(folder / "a.journal", header));
  ASSERT_TRUE(JournalWriter::create(folder / "b.journal", header));
  const auto a = read_journal(folder / "a.journal");
  const auto b = read_journal(folder / "b.journal");
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->record.header.uuid.size(), 36U);
  EXPECT_NE(a->record.header.uuid, b->record.header.uuid);
}

TEST(Journal, RefusesWhatIsNoJournalInOneLine) {
  const TemporaryFolder folder;
  test::write_content(folder / "text.journal", "this is a text, longer than the head of an entry is");
  test::write_content(folder / "empty.journal", "");
  for (const char* name : {"text.journal", "empty.journal", "missing.journal", "."}) {
    const auto read = read_journal(folder / name);
    ASSERT_FALSE(read) << name;
    EXPECT_EQ(read.error().exit_status(), 2) << name;
    EXPECT_THAT(read.error().message, HasSubstr(name));
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
  }
}

// RLIMIT_FSIZE stands for a full disk: write() stops short of the limit and then fails.
TEST(Journal, ShortWriteIsTakenBackAndMayBeTriedAgain) {
  const TemporaryFolder folder;
  auto journal = JournalWriter::create(folder / "a.journal", test::sample_header());
  ASSERT_TRUE(journal);
  const std::vector<double> scans(100, 7.0);
  ASSERT_TRUE(journal->append_scans(0, scans, {}));
  const std::uint64_t size = journal->size();

  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{size + 50, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  const auto refused = journal->append_scans(100, scans, {});
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().exit_status(), 1);
  EXPECT_THAT(refused.error().message, HasSubstr("File too large"));
  EXPECT_EQ(std::filesystem::file_size(folder / "a.journal"), size);

  ASSERT_TRUE(journal->append_scans(100, scans, {}));
  const auto read = read_journal(folder / "a.journal");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->record.raw.size(), 200U);
  EXPECT_EQ(read->why_unread(), "");
}

TEST(JournalDeathTest, CountsTheBoardCannotGiveStopTheProgram) {
  const TemporaryFolder folder;
  auto journal = JournalWriter::create(folder / "a.journal", test::sample_header());
  ASSERT_TRUE(journal);
  for (const double count : {-1.0, 65536.0, 0.5, std::nan("")}) {
    EXPECT_DEATH(static_cast<void>(journal->append_scans(0, {&count, 1}, {})), "contract broken") << count;
  }
}

}  // namespace
}  // namespace stickslip

// Whatever a disk does to a journal: what can be read is in the record, and nothing is removed that cannot.

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/record/finaliser.hpp"
#include "core/record/reader.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/journal_samples.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSector = 512;
constexpr std::size_t kPage = 4096;
constexpr daq::ScanIndex kGap = 1500;

/// A journal of some tens of kilobytes with entries of every type, written once.
class SoundJournal {
 public:
  SoundJournal() {
    record = test::whole_record();
    record.scan.clear();
    record.raw.clear();
    record.second.clear();
    record.true_coefficient.clear();
    record.gaps = {{kGap, 20, true, daq::GapCause::kOverrun}};
    for (int i = 0; i < kScans; ++i) {
      record.scan.push_back(i < kScans / 2 ? 1000 + i : 1020 + i);
      record.raw.push_back(i * 31 % 65536);
      record.second.push_back(i * 17 % 4096);
      record.true_coefficient.push_back(0.3 + 0.01 * std::sin(0.1 * i));
    }
    const test::TemporaryFolder folder;
    const std::vector<std::uint64_t> ends = test::write_journal(folder / "a.journal", record);
    content = test::content_of(folder / "a.journal");
    std::uint64_t begin = 0;
    for (const std::uint64_t end : ends) {
      entries.push_back(content.substr(begin, end - begin));
      begin = end;
    }
  }

  static constexpr int kScans = 1'000;
  record::Record record;
  std::string content;
  std::vector<std::string> entries;  ///< The header first.
};

const SoundJournal& sound_journal() {
  static const SoundJournal sound;
  return sound;
}

std::size_t below(std::size_t end) { return *rc::gen::inRange<std::size_t>(0, end); }

/// \return what was done.
std::string damage(std::string& content) {
  const std::size_t kind = below(5);
  const std::size_t at = below(content.size());
  const auto zero = [&](std::size_t size) {
    const std::size_t begin = at / size * size;
    const std::size_t count = std::min(size, content.size() - begin);
    content.replace(begin, count, count, '\0');
    return fmt::format("zeroed {} from {}", count, begin);
  };
  switch (kind) {
    case 0:
      content[at] = static_cast<char>(content[at] ^ (1 << below(8)));
      return fmt::format("flipped a bit at {}", at);
    case 1:
      return zero(kSector);
    case 2:
      return zero(kPage);
    case 3:
      content.resize(at);
      return fmt::format("cut at {}", at);
    default: {
      const std::size_t pages = content.size() / kPage;
      const std::size_t a = below(pages) * kPage;
      const std::size_t b = below(pages) * kPage;
      std::swap_ranges(content.begin() + static_cast<std::ptrdiff_t>(a),
                       content.begin() + static_cast<std::ptrdiff_t>(a + kPage),
                       content.begin() + static_cast<std::ptrdiff_t>(b));
      return fmt::format("swapped the pages at {} and {}", a, b);
    }
  }
}

record::EntryHead head_of(const std::string& entry) {
  record::EntryHead head;
  std::memcpy(&head, entry.data(), sizeof head);
  return head;
}

/// Which entries still stand somewhere. Without a checksum: byte for byte.
std::vector<bool> standing(const std::string& content) {
  std::vector<bool> standing;
  for (const std::string& entry : sound_journal().entries)
    standing.push_back(content.find(entry) != std::string::npos);
  return standing;
}

std::size_t size_of(const std::vector<bool>& stands) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < stands.size(); ++i) size += stands[i] ? sound_journal().entries[i].size() : 0;
  return size;
}

/// Scan → count that have to be in the record.
std::map<daq::ScanIndex, double> readable(const std::vector<bool>& stands) {
  std::map<daq::ScanIndex, double> scans;
  const record::Record& whole = sound_journal().record;
  for (std::size_t i = 0; i < stands.size(); ++i) {
    const record::EntryHead head = head_of(sound_journal().entries[i]);
    if (!stands[i] || head.type != static_cast<std::uint16_t>(record::EntryType::kScans)) continue;
    const auto row =
        static_cast<std::size_t>(std::ranges::lower_bound(whole.scan, head.first_scan) - whole.scan.begin());
    for (std::size_t k = 0; k < head.payload_size / sizeof(std::uint16_t); ++k)
      scans[whole.scan[row + k]] = whole.raw[row + k];
  }
  return scans;
}

void expect_gaps_between(const record::Record& read) {
  std::map<daq::ScanIndex, const daq::Gap*> gaps;
  for (const daq::Gap& gap : read.gaps) gaps[gap.first] = &gap;
  for (std::size_t i = 1; i < read.scan.size(); ++i) {
    for (daq::ScanIndex scan = read.scan[i - 1] + 1; scan < read.scan[i];) {
      RC_ASSERT(gaps.contains(scan));
      RC_ASSERT(gaps[scan]->cause == daq::GapCause::kDamaged || scan == kGap);
      scan += gaps[scan]->count;
    }
  }
}

record::EndRecord evaluate(const record::Record& record) {
  record::EndRecord end;
  end.results = record::absent_results(fmt::format("evaluated with {} scans", record.scan.size()));
  return end;
}

RC_GTEST_PROP(JournalDamage, LosesWhatItHitsAndNothingElse, ()) {
  const test::TemporaryFolder folder;
  const fs::path journal = folder / "a.journal";
  std::string content = sound_journal().content;
  for (std::size_t times = 1 + below(3); times > 0 && !content.empty(); --times)
    RC_LOG() << damage(content) << "\n";
  test::write_content(journal, content);
  const std::vector<bool> stands = standing(content);

  // As the daemon does, which knows what it wrote, or as somebody does later.
  const std::optional<std::int64_t> expected =
      below(2) == 0 ? std::optional{SoundJournal::kScans} : std::nullopt;

  const auto made = record::finalise(journal, evaluate, record::system_calls(), {}, expected);

  if (!stands.front()) {
    // Nobody knows what the counts mean.
    RC_ASSERT(!made);
    RC_ASSERT(test::content_of(journal) == content);
    RC_ASSERT(!fs::exists(folder / "a.h5"));
    return;
  }
  if (!made) RC_FAIL(made.error().message);
  const auto read = record::read_record(made->file);
  if (!read) RC_FAIL(read.error().message);
  std::map<daq::ScanIndex, double> scans;
  for (std::size_t i = 0; i < read->scan.size(); ++i) scans[read->scan[i]] = read->raw[i];
  RC_ASSERT(scans == readable(stands));
  RC_ASSERT(made->scan_count == static_cast<std::int64_t>(scans.size()));
  RC_ASSERT(record::judge(made->file).judgement != record::Judgement::kDamaged);
  expect_gaps_between(*read);

  const bool all_stand = std::ranges::find(stands, false) == stands.end();
  RC_ASSERT((read->end->status == record::Status::kComplete) == all_stand);
  // Results are never those of other scans than the record's.
  if (!all_stand && stands.back() && !scans.empty()) {
    RC_ASSERT(read->end->results == evaluate(*read).results);
  }
  const bool has_fewer = expected && made->scan_count < *expected;
  const std::string told = fmt::format("{} scans were written to the journal, {} could be read",
                                       SoundJournal::kScans, made->scan_count);
  RC_ASSERT(has_fewer == (std::ranges::find(read->end->reasons, told) != read->end->reasons.end()));
  RC_ASSERT(!has_fewer || read->end->status != record::Status::kRecovered);
  // Nothing but an end that a stop can leave so is ever removed, and that only if no scan is known to be
  // lost.
  RC_ASSERT(!fs::exists(journal));
  if (made->kept.empty()) {
    const auto first_lost = std::ranges::find(stands, false);
    RC_ASSERT(std::find(first_lost, stands.end(), true) == stands.end());
    RC_ASSERT(made->damaged_size == 0U);
    RC_ASSERT(!has_fewer || size_of(stands) == content.size());
  } else {
    RC_ASSERT(made->kept == folder / "a.journal.damaged");
    RC_ASSERT(test::content_of(made->kept) == content);
    RC_ASSERT(made->damaged_size > 0U || has_fewer);
  }
}

}  // namespace
}  // namespace stickslip

#include <algorithm>
#include <cstring>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/base/wording.hpp"
#include "core/record/journal.hpp"
#include "core/record/journal_entries.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/range_check.hpp"

namespace stickslip::record {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::int32_t kNoCode = daq::SecondChannel::kNoCode;

std::string_view text_of(const Entry& entry) {
  return {reinterpret_cast<const char*>(entry.payload.data()), entry.payload.size()};
}

template <typename T>
std::vector<T> values_of(std::span<const std::byte> bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// In board.quantity. \throws std::invalid_argument for an encoding that scans cannot have.
std::vector<double> raw_of(const Entry& entry) {
  const auto widened = [](const auto& values) { return std::vector<double>(values.begin(), values.end()); };
  switch (static_cast<Encoding>(entry.head.encoding)) {
    case Encoding::kU16:
      return widened(values_of<std::uint16_t>(entry.payload));
    case Encoding::kU32:
      return widened(values_of<std::uint32_t>(entry.payload));
    case Encoding::kF64:
      return values_of<double>(entry.payload);
    case Encoding::kNone:
    default:
      throw std::invalid_argument("unknown encoding of scans");
  }
}

/// Values of an entry whose scans are there. \param runs  rising.
/// \param use  called with the row of the first, which value of the entry it is, and how many follow it.
template <typename Use>
void for_each_common(const std::vector<ScanRun>& runs, const EntryPlace& place, const Use& use) {
  auto run = std::ranges::upper_bound(runs, place.first, {}, &ScanRun::end);
  for (; run != runs.end() && run->first < place.end(); ++run) {
    const daq::ScanIndex first = std::max(run->first, place.first);
    const daq::ScanIndex end = std::min(run->end(), place.end());
    use(run->row + static_cast<std::size_t>(first - run->first),
        static_cast<std::size_t>(first - place.first), static_cast<std::size_t>(end - first));
  }
}

/// What the entries come to.
class Content {
 public:
  explicit Content(JournalReading& reading) : reading_(reading) {}

  /// \param position  where the entry stands. \throws std::exception if its content makes no sense.
  void add(const Entry& entry, std::uint64_t position) {
    Record& record = reading_.record;
    const auto place = [&](std::size_t count) {
      const daq::ScanIndex first = range_checked(entry.head.first_scan);
      if (count > 0) range_checked(first + static_cast<daq::ScanIndex>(count) - 1);
      return EntryPlace{position, kEntryHeadSize + entry.payload.size(), first, count};
    };
    switch (static_cast<EntryType>(entry.head.type)) {
      case EntryType::kScans:
        reading_.scans.push_back(place(checked_scan_count(entry)));
        return;
      case EntryType::kTrueForce:
        reading_.true_coefficients.push_back(place(values_of<double>(entry.payload).size()));
        return;
      case EntryType::kSecond:
        reading_.second_codes.push_back(place(checked_code_count(entry)));
        return;
      case EntryType::kSpikes: {
        const auto spikes = values_of<daq::ScanIndex>(entry.payload);
        record.spikes.insert(record.spikes.end(), spikes.begin(), spikes.end());
        return;
      }
      case EntryType::kGap:
        record.gaps.push_back(gap_from_json(text_of(entry)));
        return;
      case EntryType::kCycle:
        record.cycles.push_back(cycle_from_json(text_of(entry)));
        return;
      case EntryType::kAnchor: {
        const auto times = values_of<std::int64_t>(entry.payload);
        record.anchors.push_back(range_checked(ClockAnchor{entry.head.first_scan, times.at(0), times.at(1)}));
        return;
      }
      case EntryType::kEvent:
        record.events.push_back(event_from_json(text_of(entry)));
        return;
      case EntryType::kEnd:
        if (end_) throw std::invalid_argument("a second end");
        end_ = end_from_bytes(entry.payload);
        return;
      case EntryType::kHeader:
        throw std::invalid_argument("a second header");
      default:
        throw std::invalid_argument("unknown type of entry");
    }
  }

  /// Brings all into the order of the scans. \param is_damaged  something was no whole entry.
  void finish(bool is_damaged) {
    keep_rising(reading_.scans);
    for (const EntryPlace& place : reading_.scans) {
      std::vector<ScanRun>& runs = reading_.runs;
      if (runs.empty() || place.first != runs.back().end())
        runs.push_back({place.first, 0, reading_.scan_count});
      runs.back().count += place.count;
      reading_.scan_count += place.count;
    }
    for (auto* places : {&reading_.true_coefficients, &reading_.second_codes}) {
      keep_rising(*places);
      const auto is_idle = [&](const EntryPlace& place) {
        std::size_t common = 0;
        for_each_common(reading_.runs, place,
                        [&](std::size_t, std::size_t, std::size_t count) { common += count; });
        return common == 0;
      };
      // Where scans are damaged, what belongs to them is whole all the same.
      if (is_damaged || !reading_.damaged.empty()) {
        std::erase_if(*places, is_idle);
      } else {
        refuse_if(*places, "values of scans that are not there", is_idle);
      }
    }
    Record& record = reading_.record;
    std::ranges::stable_sort(record.anchors, {}, &ClockAnchor::scan);
    std::ranges::stable_sort(record.gaps, {}, &daq::Gap::first);
    std::ranges::sort(record.spikes);
    if (end_) set_end(record, *std::move(end_));
  }

 private:
  [[nodiscard]] std::size_t checked_scan_count(const Entry& entry) const {
    const std::vector<double> raw = raw_of(entry);
    const daq::BoardInfo& board = reading_.record.header.board;
    const auto maxdata = static_cast<double>(board.maxdata);
    if (board.quantity == daq::RawQuantity::kCounts &&
        !std::ranges::all_of(raw, [&](double count) { return count <= maxdata; })) {
      throw std::invalid_argument("count above maxdata");
    }
    return raw.size();
  }

  [[nodiscard]] std::size_t checked_code_count(const Entry& entry) const {
    const auto& channel = reading_.record.header.board.second;
    if (!channel) throw std::invalid_argument("codes of a second channel that is not there");
    const auto codes = values_of<std::int32_t>(entry.payload);
    const auto possible = [&](std::int32_t code) {
      return code >= kNoCode && code <= static_cast<std::int64_t>(channel->maxdata);
    };
    if (!std::ranges::all_of(codes, possible)) {
      throw std::invalid_argument("code of the second channel out of range");
    }
    return codes.size();
  }

  /// Scans that stand there twice are read once.
  void keep_rising(std::deque<EntryPlace>& places) {
    // Sorting takes as much memory again.
    if (!std::ranges::is_sorted(places, {}, &EntryPlace::first))
      std::ranges::stable_sort(places, {}, &EntryPlace::first);
    std::erase_if(places, [](const EntryPlace& place) { return place.count == 0; });
    std::optional<daq::ScanIndex> end;
    refuse_if(places, "scans that stand there already", [&end](const EntryPlace& place) {
      if (end && place.first < *end) return true;
      end = place.end();
      return false;
    });
  }

  void refuse_if(std::deque<EntryPlace>& places, const char* why,
                 const std::function<bool(const EntryPlace&)>& refused) {
    std::erase_if(places, [&](const EntryPlace& place) {
      if (!refused(place)) return false;
      reading_.damaged.push_back({place.position, place.size, why});
      return true;
    });
  }

  JournalReading& reading_;
  std::optional<EndRecord> end_;
};

/// What is missing between the runs, as far as no gap of the journal says why. \param gaps  rising.
std::vector<daq::Gap> holes(const std::vector<ScanRun>& runs, const std::vector<daq::Gap>& gaps,
                            daq::GapCause cause) {
  std::vector<daq::Gap> found;
  const auto missing = [&](daq::ScanIndex first, daq::ScanIndex end) {
    if (first < end) found.push_back({first, end - first, false, cause});
  };
  auto gap = gaps.begin();
  for (std::size_t i = 1; i < runs.size(); ++i) {
    daq::ScanIndex first = runs[i - 1].end();
    for (; gap != gaps.end() && gap->first < runs[i].first; ++gap) {
      missing(first, gap->first);
      first = std::max(first, gap->first + gap->count);
    }
    missing(first, runs[i].first);
  }
  return found;
}

void keep_scans(const std::filesystem::path& path, JournalReading& reading, const FileCalls& calls) {
  Record& record = reading.record;
  const JournalScanSource source{path, reading, calls};
  const auto append = [](auto& column, const auto& piece) {
    column.insert(column.end(), piece.begin(), piece.end());
  };
  source.for_each_piece([&](const ScanPiece& piece) {
    append(record.scan, piece.scan);
    append(record.raw, piece.raw);
  });
  if (source.has_force())
    source.for_each_force_piece(
        [&](std::span<const double> piece) { append(record.true_coefficient, piece); });
  if (source.has_second())
    source.for_each_second_piece([&](std::span<const std::int32_t> piece) { append(record.second, piece); });
}

/// The header, wherever it stands: first, unless a disk has swapped pages.
/// \param format_version  takes the header's.
base::Result<RecordHeader> find_header(const std::filesystem::path& path, const FileCalls& calls,
                                       std::int64_t& format_version) {
  auto entries = JournalEntries::open(path, calls);
  if (!entries) return tl::unexpected(entries.error());
  std::uint64_t others = 0;
  while (const auto entry = entries->next()) {
    if (entry->head.type != static_cast<std::uint16_t>(EntryType::kHeader)) {
      ++others;
      continue;
    }
    try {
      return header_from_json(text_of(*entry), &format_version);
    } catch (const std::exception& error) {
      return base::usage_error("{}: is no journal of this program: {}", path.string(),
                               base::reason_of(error));
    }
  }
  if (!entries->error().empty()) return base::failure("{}: {}", path.string(), entries->error());
  const auto& skipped = entries->skipped();
  const std::string why = !skipped.empty()            ? skipped.front().why
                          : entries->torn_end()       ? entries->torn_end()->why
                          : entries->file_size() == 0 ? "it is empty"
                                                      : "no entry is a header";
  if (others == 0) {
    return base::usage_error(
        "{}: is no journal of this program: {}; no scan can be read from its {} bytes: move it away",
        path.string(), why, entries->file_size());
  }
  return base::failure(
      "{}: its header, at byte 0, is damaged ({}): what board and load cell the {} whole entries behind it "
      "belong "
      "to is not known, so no record can be made; the journal stays as it is: put a copy from a backup in "
      "its "
      "place, or move it away",
      path.string(), why, others);
}

}  // namespace

std::uint64_t JournalReading::damaged_size() const noexcept {
  std::uint64_t size = 0;
  for (const UnreadBytes& bytes : damaged) size += bytes.size;
  return size;
}

std::string JournalReading::why_unread() const {
  if (!damaged.empty()) return damaged.front().why;
  return torn_end ? torn_end->why : std::string{};
}

base::Result<JournalReading> read_journal(const std::filesystem::path& path, JournalScans scans,
                                          const FileCalls& calls) {
  JournalReading reading;
  auto header = find_header(path, calls, reading.format_version);
  if (!header) return tl::unexpected(header.error());
  auto entries = JournalEntries::open(path, calls);
  if (!entries) return tl::unexpected(entries.error());

  reading.record.header = *std::move(header);
  reading.file_size = entries->file_size();
  Content content{reading};
  bool header_seen = false;
  while (const auto entry = entries->next()) {
    if (!header_seen && entry->head.type == static_cast<std::uint16_t>(EntryType::kHeader)) {
      header_seen = true;
      continue;
    }
    try {
      content.add(*entry, entries->position());
    } catch (const std::exception& error) {
      reading.damaged.push_back(
          {entries->position(), kEntryHeadSize + entry->payload.size(), base::reason_of(error)});
    }
  }
  if (!entries->error().empty()) return base::failure("{}: {}", path.string(), entries->error());
  content.finish(!entries->skipped().empty());
  reading.torn_end = entries->torn_end();
  reading.damaged.insert(reading.damaged.end(), entries->skipped().begin(), entries->skipped().end());
  std::ranges::stable_sort(reading.damaged, {}, &UnreadBytes::first);
  std::vector<daq::Gap>& gaps = reading.record.gaps;
  const std::vector<daq::Gap> missing = holes(
      reading.runs, gaps, reading.why_unread().empty() ? daq::GapCause::kUnknown : daq::GapCause::kDamaged);
  gaps.insert(gaps.end(), missing.begin(), missing.end());
  std::ranges::stable_sort(gaps, {}, &daq::Gap::first);
  if (scans == JournalScans::kKeep) {
    try {
      keep_scans(path, reading, calls);
    } catch (const std::runtime_error& error) {
      return base::failure("{}", error.what());
    }
  }
  return reading;
}

void JournalScanSource::for_each_entry(const std::deque<EntryPlace>& places,
                                       const std::function<void(const Entry&)>& use) const {
  auto entries = JournalEntries::open(path_, calls_);
  if (!entries) throw std::runtime_error(entries.error().message);
  for (const EntryPlace& place : places) {
    const auto entry = entries->at(place.position);
    if (!entries->error().empty()) throw std::runtime_error(path_.string() + ": " + entries->error());
    if (!entry || entry->head.first_scan != place.first ||
        kEntryHeadSize + entry->payload.size() != place.size) {
      throw std::runtime_error(path_.string() + ": changed while it was read");
    }
    use(*entry);
  }
}

void JournalScanSource::for_each_piece(const std::function<void(const ScanPiece&)>& use) const {
  std::vector<daq::ScanIndex> scan;
  std::vector<double> raw;
  scan.reserve(kPiece);
  raw.reserve(kPiece);
  const auto pass_on = [&] {
    if (!scan.empty()) use({scan, raw});
    scan.clear();
    raw.clear();
  };
  for_each_entry(reading_.scans, [&](const Entry& entry) {
    daq::ScanIndex index = entry.head.first_scan;
    for (const double value : raw_of(entry)) {
      scan.push_back(index++);
      raw.push_back(value);
      if (scan.size() == kPiece) pass_on();
    }
  });
  pass_on();
}

template <typename Value>
void JournalScanSource::for_each_column_piece(const std::deque<EntryPlace>& places, Value absent,
                                              const std::function<void(std::span<const Value>)>& use) const {
  std::vector<Value> piece;
  piece.reserve(kPiece);
  std::size_t row = 0;
  const auto push = [&](Value value) {
    piece.push_back(value);
    ++row;
    if (piece.size() < kPiece) return;
    use(piece);
    piece.clear();
  };
  const auto leave_out_up_to = [&](std::size_t end) {
    for (std::size_t left = std::max(end, row) - row; left > 0; --left) push(absent);
  };
  auto place = places.begin();
  for_each_entry(places, [&](const Entry& entry) {
    const std::vector<Value> values = values_of<Value>(entry.payload);
    for_each_common(reading_.runs, *place++, [&](std::size_t at, std::size_t offset, std::size_t count) {
      leave_out_up_to(at);
      for (std::size_t i = 0; i < count; ++i) push(values[offset + i]);
    });
  });
  leave_out_up_to(size());
  if (!piece.empty()) use(piece);
}

void JournalScanSource::for_each_force_piece(const std::function<void(std::span<const double>)>& use) const {
  for_each_column_piece<double>(reading_.true_coefficients, kNaN, use);
}

void JournalScanSource::for_each_second_piece(
    const std::function<void(std::span<const std::int32_t>)>& use) const {
  for_each_column_piece<std::int32_t>(reading_.second_codes, kNoCode, use);
}

}  // namespace stickslip::record

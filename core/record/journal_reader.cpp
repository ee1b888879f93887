#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>

#include "core/base/wording.hpp"
#include "core/record/journal.hpp"
#include "core/record/journal_entries.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/possible.hpp"

namespace stickslip::record {
namespace {

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
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

/// What the entries come to, whether the scans are kept or only counted.
class Content {
 public:
  Content(JournalReading& reading, bool keep_scans) : reading_(reading), keep_(keep_scans) {}

  /// \throws std::exception if the entry's content makes no sense.
  void add(const Entry& entry) {
    Record& record = reading_.record;
    switch (static_cast<EntryType>(entry.head.type)) {
      case EntryType::kScans:
        return add_scans(entry);
      case EntryType::kTrueForce:
        return add_force(entry);
      case EntryType::kSecond:
        return add_second(entry);
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
        record.anchors.push_back(possible(ClockAnchor{entry.head.first_scan, times.at(0), times.at(1)}));
        return;
      }
      case EntryType::kEvent:
        record.events.push_back(event_from_json(text_of(entry)));
        return;
      case EntryType::kEnd:
        set_end(record, end_from_bytes(entry.payload));
        return;
      case EntryType::kHeader:
      default:
        throw std::invalid_argument("unknown type of entry");
    }
  }

  void finish() {
    if (keep_ && reading_.has_force) reading_.record.true_coefficient.resize(reading_.scan_count, kNotKnown);
    if (keep_ && reading_.has_second) reading_.record.second.resize(reading_.scan_count, kNoCode);
  }

 private:
  void add_scans(const Entry& entry) {
    Record& record = reading_.record;
    std::vector<ScanRun>& runs = reading_.runs;
    const daq::ScanIndex first = possible(entry.head.first_scan);
    if (!runs.empty() && first < runs.back().end()) throw std::invalid_argument("scan indices run backwards");
    const std::vector<double> raw = raw_of(entry);
    if (record.header.board.quantity == daq::RawQuantity::kCounts) {
      const auto maxdata = static_cast<double>(record.header.board.maxdata);
      const auto possible = [&](double count) { return count <= maxdata; };
      if (!std::all_of(raw.begin(), raw.end(), possible)) throw std::invalid_argument("count above maxdata");
    }
    if (raw.empty()) return;
    possible(first + static_cast<daq::ScanIndex>(raw.size()) - 1);
    if (runs.empty() || first != runs.back().end()) runs.push_back({first, 0, reading_.scan_count});
    runs.back().count += raw.size();
    reading_.scan_count += raw.size();
    if (!keep_) return;
    record.raw.insert(record.raw.end(), raw.begin(), raw.end());
    for (daq::ScanIndex scan = first; record.scan.size() < record.raw.size(); ++scan) {
      record.scan.push_back(scan);
    }
  }

  void add_force(const Entry& entry) {
    const std::vector<double> values = values_of<double>(entry.payload);
    const std::size_t row = row_of(reading_.runs, entry.head.first_scan, values.size());
    if (row < next_force_row_) throw std::invalid_argument("true force runs backwards");
    next_force_row_ = row + values.size();
    reading_.has_force = true;
    if (!keep_) return;
    std::vector<double>& force = reading_.record.true_coefficient;
    force.resize(row, kNotKnown);
    force.insert(force.end(), values.begin(), values.end());
  }

  void add_second(const Entry& entry) {
    const auto& channel = reading_.record.header.board.second;
    if (!channel) throw std::invalid_argument("codes of a second channel that is not there");
    const auto codes = values_of<std::int32_t>(entry.payload);
    const std::size_t row = row_of(reading_.runs, entry.head.first_scan, codes.size());
    if (row < next_second_row_) throw std::invalid_argument("second channel runs backwards");
    const auto possible = [&](std::int32_t code) {
      return code >= kNoCode && code <= static_cast<std::int64_t>(channel->maxdata);
    };
    if (!std::all_of(codes.begin(), codes.end(), possible)) {
      throw std::invalid_argument("code of the second channel out of range");
    }
    next_second_row_ = row + codes.size();
    reading_.has_second = true;
    if (!keep_) return;
    std::vector<std::int32_t>& second = reading_.record.second;
    second.resize(row, kNoCode);
    second.insert(second.end(), codes.begin(), codes.end());
  }

  JournalReading& reading_;
  bool keep_;
  std::size_t next_force_row_ = 0;
  std::size_t next_second_row_ = 0;
};

}  // namespace

std::size_t row_of(const std::vector<ScanRun>& runs, daq::ScanIndex first, std::size_t count) {
  const auto after =
      std::upper_bound(runs.begin(), runs.end(), first,
                       [](daq::ScanIndex scan, const ScanRun& run) { return scan < run.first; });
  if (after != runs.begin()) {
    const ScanRun& run = *(after - 1);
    const auto offset = static_cast<std::size_t>(first - run.first);
    if (offset <= run.count && count <= run.count - offset) return run.row + offset;
  }
  throw std::invalid_argument("values of scans that are not there");
}

base::Result<JournalReading> read_journal(const std::filesystem::path& path, JournalScans scans) {
  auto entries = JournalEntries::open(path);
  if (!entries) return tl::unexpected(entries.error());

  JournalReading reading;
  reading.file_size = entries->file_size();
  Content content{reading, scans == JournalScans::kKeep};
  bool header_read = false;
  while (const auto entry = entries->next()) {
    try {
      if (reading.record.end) throw std::invalid_argument("entry after the end");
      if (header_read) {
        content.add(*entry);
      } else {
        if (entry->head.type != static_cast<std::uint16_t>(EntryType::kHeader)) {
          throw std::invalid_argument("first entry is no header");
        }
        reading.record.header = header_from_json(text_of(*entry));
        header_read = true;
      }
    } catch (const std::exception& error) {
      reading.stopped_by = base::reason_of(error);
      break;
    }
    reading.whole_size = entries->position();
  }
  if (reading.stopped_by.empty()) reading.stopped_by = entries->stopped_by();
  if (!header_read) {
    return base::usage_error("{}: is no journal of this program: {}", path.string(),
                             reading.file_size == 0 ? "it is empty" : reading.stopped_by);
  }
  content.finish();
  return reading;
}

void JournalScanSource::for_each_entry(EntryType type, const std::function<void(const Entry&)>& use) const {
  auto entries = JournalEntries::open(path_);
  if (!entries) throw std::runtime_error(entries.error().message);
  // What read_journal() did not believe is not there.
  while (entries->position() < reading_.whole_size) {
    const auto entry = entries->next();
    if (!entry) throw std::runtime_error(path_.string() + ": changed while it was read");
    if (entry->head.type == static_cast<std::uint16_t>(type)) use(*entry);
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
  for_each_entry(EntryType::kScans, [&](const Entry& entry) {
    daq::ScanIndex index = entry.head.first_scan;
    for (const double value : raw_of(entry)) {
      scan.push_back(index++);
      raw.push_back(value);
      if (scan.size() == kPiece) pass_on();
    }
  });
  pass_on();
}

template <typename Stored, typename Value>
void JournalScanSource::for_each_column_piece(EntryType type, Value absent,
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
  for_each_entry(type, [&](const Entry& entry) {
    const std::vector<Stored> values = values_of<Stored>(entry.payload);
    leave_out_up_to(row_of(reading_.runs, entry.head.first_scan, values.size()));
    for (const Stored value : values) push(value);
  });
  leave_out_up_to(size());
  if (!piece.empty()) use(piece);
}

void JournalScanSource::for_each_force_piece(const std::function<void(std::span<const double>)>& use) const {
  for_each_column_piece<double>(EntryType::kTrueForce, kNotKnown, use);
}

void JournalScanSource::for_each_second_piece(
    const std::function<void(std::span<const std::int32_t>)>& use) const {
  for_each_column_piece<std::int32_t>(EntryType::kSecond, kNoCode, use);
}

}  // namespace stickslip::record

#include <cstring>
#include <exception>

#include "core/record/journal.hpp"
#include "core/record/json_codec.hpp"

namespace stickslip::record {
namespace {

std::string_view text_of(const Entry& entry) {
  return {reinterpret_cast<const char*>(entry.payload.data()), entry.payload.size()};
}

template <typename T>
std::vector<T> values_of(const Entry& entry) {
  std::vector<T> values(entry.payload.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), entry.payload.data(), values.size() * sizeof(T));
  return values;
}

template <typename T>
void add_raw(const Entry& entry, Record& record) {
  const auto values = values_of<T>(entry);
  if (record.header.board.quantity == daq::RawQuantity::kCounts) {
    const auto maxdata = static_cast<double>(record.header.board.maxdata);
    for (const T value : values) {
      if (!(static_cast<double>(value) <= maxdata)) throw std::invalid_argument("count above maxdata");
    }
  }
  record.raw.insert(record.raw.end(), values.begin(), values.end());
}

/// \throws std::invalid_argument if the scans do not follow those before.
void add_scans(const Entry& entry, Record& record) {
  if (!record.scan.empty() && entry.head.first_scan <= record.scan.back()) {
    throw std::invalid_argument("scan indices run backwards");
  }
  switch (static_cast<Encoding>(entry.head.encoding)) {
    case Encoding::kU16:
      add_raw<std::uint16_t>(entry, record);
      break;
    case Encoding::kU32:
      add_raw<std::uint32_t>(entry, record);
      break;
    case Encoding::kF64:
      add_raw<double>(entry, record);
      break;
    case Encoding::kNone:
    default:
      throw std::invalid_argument("unknown encoding of scans");
  }
  for (daq::ScanIndex scan = entry.head.first_scan; record.scan.size() < record.raw.size(); ++scan) {
    record.scan.push_back(scan);
  }
}

/// Adds one entry. \throws std::exception if its content makes no sense.
void add(const Entry& entry, Record& record) {
  switch (static_cast<EntryType>(entry.head.type)) {
    case EntryType::kScans:
      return add_scans(entry, record);
    case EntryType::kSpikes: {
      const auto spikes = values_of<daq::ScanIndex>(entry);
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
      const auto times = values_of<std::int64_t>(entry);
      record.anchors.push_back({entry.head.first_scan, times.at(0), times.at(1)});
      return;
    }
    case EntryType::kEvent:
      record.events.push_back(event_from_json(text_of(entry)));
      return;
    case EntryType::kEnd:
      set_end(record, end_from_json(text_of(entry)));
      return;
    case EntryType::kHeader:
    default:
      throw std::invalid_argument("unknown type of entry");
  }
}

}  // namespace

base::Result<JournalReading> read_journal(const std::filesystem::path& path) {
  const auto file = read_file(path);
  if (!file) return tl::unexpected(file.error());

  JournalReading reading;
  reading.file_size = file->size();
  bool header_read = false;
  for (std::span<const std::byte> rest{*file}; !rest.empty();) {
    const auto entry = first_entry(rest, reading.stopped_by);
    if (!entry) break;
    try {
      if (reading.record.end) throw std::invalid_argument("entry after the end");
      if (header_read) {
        add(*entry, reading.record);
      } else {
        if (entry->head.type != static_cast<std::uint16_t>(EntryType::kHeader)) {
          throw std::invalid_argument("first entry is no header");
        }
        reading.record.header = header_from_json(text_of(*entry));
        header_read = true;
      }
    } catch (const std::exception& error) {
      reading.stopped_by = error.what();
      break;
    }
    rest = rest.subspan(kEntryHeadSize + entry->payload.size());
    reading.whole_size = file->size() - rest.size();
  }
  if (!header_read) {
    return base::usage_error("{}: is no journal of this program: {}", path.string(),
                             file->empty() ? "it is empty" : reading.stopped_by);
  }
  return reading;
}

}  // namespace stickslip::record

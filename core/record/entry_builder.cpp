#include "core/record/entry_builder.hpp"

#include <cmath>
#include <cstring>

#include "core/base/contract.hpp"
#include "core/record/enum_names.hpp"
#include "core/record/json_codec.hpp"

namespace stickslip::record {
namespace {

Encoding encoding_for(const daq::BoardInfo& board) {
  if (board.quantity != daq::RawQuantity::kCounts) return Encoding::kF64;
  return counts_fit_u16(board) ? Encoding::kU16 : Encoding::kU32;
}

template <typename T>
void append_value(std::vector<std::byte>& bytes, T value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace

EntryBuilder::EntryBuilder(const RecordHeader& header)
    : encoding_(encoding_for(header.board)), maxdata_(static_cast<double>(header.board.maxdata)) {
  STICKSLIP_EXPECTS(!header.uuid.empty());
  STICKSLIP_EXPECTS(header.board.quantity != daq::RawQuantity::kCounts || header.load_cell);
}

void EntryBuilder::begin() { entry_.assign(kEntryHeadSize, std::byte{0}); }

EntryBuilder::Bytes EntryBuilder::finish(EntryType type, Encoding encoding, daq::ScanIndex first_scan,
                                         std::int64_t time_ns) {
  EntryHead head;
  head.type = static_cast<std::uint16_t>(type);
  head.encoding = static_cast<std::uint16_t>(encoding);
  STICKSLIP_EXPECTS(entry_.size() - kEntryHeadSize <= std::numeric_limits<std::uint32_t>::max());
  head.payload_size = static_cast<std::uint32_t>(entry_.size() - kEntryHeadSize);
  head.first_scan = first_scan;
  head.time_ns = time_ns;
  head.crc = entry_crc(head, std::span{entry_}.subspan(kEntryHeadSize));
  std::memcpy(entry_.data(), &head, kEntryHeadSize);
  return entry_;
}

EntryBuilder::Bytes EntryBuilder::text(EntryType type, daq::ScanIndex first_scan, std::string_view json) {
  begin();
  const auto bytes = std::as_bytes(std::span{json});
  entry_.insert(entry_.end(), bytes.begin(), bytes.end());
  return finish(type, Encoding::kNone, first_scan, 0);
}

EntryBuilder::Bytes EntryBuilder::header(const RecordHeader& header) {
  return text(EntryType::kHeader, 0, header_to_json(header));
}

EntryBuilder::Bytes EntryBuilder::scans(daq::ScanIndex first, std::span<const double> raw,
                                        const daq::ClockStamp& stamp) {
  STICKSLIP_EXPECTS(!raw.empty() && first >= next_scan_);
  begin();
  for (const double value : raw) {
    if (encoding_ == Encoding::kF64) {
      append_value(entry_, value);
      continue;
    }
    STICKSLIP_EXPECTS(value >= 0.0 && value <= maxdata_ && value == std::floor(value));
    if (encoding_ == Encoding::kU16) {
      append_value(entry_, static_cast<std::uint16_t>(value));
    } else {
      append_value(entry_, static_cast<std::uint32_t>(value));
    }
  }
  next_scan_ = first + static_cast<daq::ScanIndex>(raw.size());
  return finish(EntryType::kScans, encoding_, first, stamp.monotonic_ns);
}

EntryBuilder::Bytes EntryBuilder::true_coefficients(daq::ScanIndex first,
                                                    std::span<const double> coefficient) {
  begin();
  const auto bytes = std::as_bytes(coefficient);
  entry_.insert(entry_.end(), bytes.begin(), bytes.end());
  return finish(EntryType::kTrueForce, Encoding::kF64, first, 0);
}

EntryBuilder::Bytes EntryBuilder::second(daq::ScanIndex first, std::span<const std::int32_t> codes) {
  begin();
  const auto bytes = std::as_bytes(codes);
  entry_.insert(entry_.end(), bytes.begin(), bytes.end());
  return finish(EntryType::kSecond, Encoding::kNone, first, 0);
}

EntryBuilder::Bytes EntryBuilder::spikes(std::span<const daq::ScanIndex> spikes) {
  begin();
  for (const daq::ScanIndex spike : spikes) append_value(entry_, spike);
  return finish(EntryType::kSpikes, Encoding::kNone, 0, 0);
}

EntryBuilder::Bytes EntryBuilder::gap(const daq::Gap& gap) {
  return text(EntryType::kGap, gap.first, gap_to_json(gap));
}

EntryBuilder::Bytes EntryBuilder::cycle(const detect::Cycle& cycle) {
  return text(EntryType::kCycle, cycle.first_scan, cycle_to_json(cycle));
}

EntryBuilder::Bytes EntryBuilder::anchor(const ClockAnchor& anchor) {
  begin();
  append_value(entry_, anchor.monotonic_ns);
  append_value(entry_, anchor.realtime_ns);
  return finish(EntryType::kAnchor, Encoding::kNone, anchor.scan, anchor.monotonic_ns);
}

EntryBuilder::Bytes EntryBuilder::event(const Event& event) {
  return text(EntryType::kEvent, event.scan, event_to_json(event));
}

EntryBuilder::Bytes EntryBuilder::end(const EndRecord& end) {
  begin();
  append_end_bytes(end, entry_);
  return finish(EntryType::kEnd, Encoding::kNone, 0, 0);
}

}  // namespace stickslip::record

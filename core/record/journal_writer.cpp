#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/base/contract.hpp"
#include "core/record/journal.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/words.hpp"

namespace stickslip::record {
namespace {

constexpr mode_t kFileMode = 0644;

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

/// write() until all is written or an error; \return bytes written, errno set if fewer.
std::size_t write_all(int descriptor, std::span<const std::byte> bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t status = ::write(descriptor, bytes.data() + written, bytes.size() - written);
    if (status < 0 && errno == EINTR) continue;
    if (status <= 0) break;
    written += static_cast<std::size_t>(status);
  }
  return written;
}

}  // namespace

JournalWriter::JournalWriter(std::filesystem::path path, Descriptor file, const daq::BoardInfo& board)
    : path_(std::move(path)),
      file_(std::move(file)),
      encoding_(encoding_for(board)),
      maxdata_(static_cast<double>(board.maxdata)) {}

base::Result<JournalWriter> JournalWriter::create(const std::filesystem::path& path, RecordHeader header) {
  STICKSLIP_EXPECTS(header.board.quantity != daq::RawQuantity::kCounts || header.load_cell);
  if (header.uuid.empty()) header.uuid = make_uuid();

  Descriptor file{::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, kFileMode)};
  if (!file.open()) {
    return base::failure("{}: cannot be created: {}", path.string(), system_message(errno));
  }
  JournalWriter journal{path, std::move(file), header.board};
  auto written = journal.append_text(EntryType::kHeader, 0, header_to_json(header));
  if (written && ::fsync(journal.file_.get()) != 0) {
    written = base::failure("{}: cannot be made durable: {}", path.string(), system_message(errno));
  }
  if (written) written = sync_path(folder_of(path));
  if (!written) {
    ::unlink(path.c_str());
    return tl::unexpected(written.error());
  }
  return journal;
}

base::Result<void> JournalWriter::append(EntryType type, Encoding encoding, daq::ScanIndex first_scan,
                                         std::int64_t time_ns) {
  if (!broken_.empty()) return base::failure("{}", broken_);
  EntryHead head;
  head.type = static_cast<std::uint16_t>(type);
  head.encoding = static_cast<std::uint16_t>(encoding);
  STICKSLIP_EXPECTS(entry_.size() - kEntryHeadSize <= std::numeric_limits<std::uint32_t>::max());
  head.payload_size = static_cast<std::uint32_t>(entry_.size() - kEntryHeadSize);
  head.first_scan = first_scan;
  head.time_ns = time_ns;
  head.crc = entry_crc(head, std::span{entry_}.subspan(kEntryHeadSize));
  std::memcpy(entry_.data(), &head, kEntryHeadSize);

  const std::size_t written = write_all(file_.get(), entry_);
  if (written == entry_.size()) {
    size_ += written;
    return {};
  }
  const std::string message = fmt::format("{}: {} of {} bytes written at byte {}: {}", path_.string(),
                                          written, entry_.size(), size_, system_message(errno));
  // Back to the last whole entry, so that what follows is readable.
  if (written > 0 && ::ftruncate(file_.get(), static_cast<off_t>(size_)) != 0) {
    broken_ = fmt::format("{}; cannot be cut back: {}", message, system_message(errno));
    return base::failure("{}", broken_);
  }
  return base::failure("{}", message);
}

base::Result<void> JournalWriter::append_text(EntryType type, daq::ScanIndex first_scan,
                                              std::string_view json) {
  entry_.assign(kEntryHeadSize, std::byte{0});
  const auto text = std::as_bytes(std::span{json});
  entry_.insert(entry_.end(), text.begin(), text.end());
  return append(type, Encoding::kNone, first_scan, 0);
}

base::Result<void> JournalWriter::append_scans(daq::ScanIndex first, std::span<const double> raw,
                                               const daq::ClockStamp& stamp) {
  STICKSLIP_EXPECTS(!raw.empty() && first >= next_scan_);
  entry_.assign(kEntryHeadSize, std::byte{0});
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
  auto appended = append(EntryType::kScans, encoding_, first, stamp.monotonic_ns);
  if (appended) next_scan_ = first + static_cast<daq::ScanIndex>(raw.size());
  return appended;
}

base::Result<void> JournalWriter::append_true_coefficients(daq::ScanIndex first,
                                                           std::span<const double> coefficient) {
  entry_.assign(kEntryHeadSize, std::byte{0});
  const auto bytes = std::as_bytes(coefficient);
  entry_.insert(entry_.end(), bytes.begin(), bytes.end());
  return append(EntryType::kTrueForce, Encoding::kF64, first, 0);
}

base::Result<void> JournalWriter::append_second(daq::ScanIndex first, std::span<const std::int32_t> codes) {
  entry_.assign(kEntryHeadSize, std::byte{0});
  const auto bytes = std::as_bytes(codes);
  entry_.insert(entry_.end(), bytes.begin(), bytes.end());
  return append(EntryType::kSecond, Encoding::kNone, first, 0);
}

base::Result<void> JournalWriter::append_spikes(std::span<const daq::ScanIndex> spikes) {
  entry_.assign(kEntryHeadSize, std::byte{0});
  for (const daq::ScanIndex spike : spikes) append_value(entry_, spike);
  return append(EntryType::kSpikes, Encoding::kNone, 0, 0);
}

base::Result<void> JournalWriter::append_gap(const daq::Gap& gap) {
  return append_text(EntryType::kGap, gap.first, gap_to_json(gap));
}

base::Result<void> JournalWriter::append_cycle(const friction::Cycle& cycle) {
  return append_text(EntryType::kCycle, cycle.first_scan, cycle_to_json(cycle));
}

base::Result<void> JournalWriter::append_anchor(const ClockAnchor& anchor) {
  entry_.assign(kEntryHeadSize, std::byte{0});
  append_value(entry_, anchor.monotonic_ns);
  append_value(entry_, anchor.realtime_ns);
  return append(EntryType::kAnchor, Encoding::kNone, anchor.scan, anchor.monotonic_ns);
}

base::Result<void> JournalWriter::append_event(const Event& event) {
  return append_text(EntryType::kEvent, event.scan, event_to_json(event));
}

base::Result<void> JournalWriter::append_end(const EndRecord& end) {
  entry_.assign(kEntryHeadSize, std::byte{0});
  append_end_bytes(end, entry_);
  return append(EntryType::kEnd, Encoding::kNone, 0, 0);
}

base::Result<void> JournalWriter::sync() {
  if (::fdatasync(file_.get()) != 0) {
    return base::failure("{}: cannot be made durable: {}", path_.string(), system_message(errno));
  }
  return {};
}

}  // namespace stickslip::record

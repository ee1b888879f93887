// Whatever stands in a journal, with checksums that are right or, where the input says so, not: the entries
// that make sense are read, the scans rise, and it is judged. The first byte says whether a header comes
// before it.

#include <fuzzer/FuzzedDataProvider.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "core/base/contract.hpp"
#include "core/record/journal.hpp"
#include "core/record/journal_format.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/record_samples.hpp"

namespace {

using namespace stickslip;

void append(std::string& file, record::EntryHead head, const std::string& payload) {
  head.payload_size = static_cast<std::uint32_t>(payload.size());
  head.crc = record::entry_crc(head, std::as_bytes(std::span{payload}));
  std::array<char, record::kEntryHeadSize> bytes{};
  std::memcpy(bytes.data(), &head, bytes.size());
  file.append(bytes.data(), bytes.size());
  file += payload;
}

record::EntryHead head_of(record::EntryType type) {
  record::EntryHead head;
  head.type = static_cast<std::uint16_t>(type);
  return head;
}

/// What the entries are judged by. It is the same each time: what else a header has would only take time.
record::RecordHeader short_header() {
  const record::RecordHeader whole = test::sample_header();
  record::RecordHeader header;
  header.uuid = whole.uuid;
  header.board = whole.board;
  header.load_cell = whole.load_cell;
  return header;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string header = record::header_to_json(short_header());
  static const std::string name = [] {
    const int file = ::memfd_create("test.journal", MFD_CLOEXEC);
    STICKSLIP_EXPECTS(file >= 0);
    return "/proc/self/fd/" + std::to_string(file);
  }();
  FuzzedDataProvider input{data, size};
  std::string bytes;
  if (input.ConsumeBool()) append(bytes, head_of(record::EntryType::kHeader), header);
  while (input.remaining_bytes() > 0) {
    record::EntryHead head;
    head.type = input.ConsumeIntegralInRange<std::uint16_t>(0, 11);
    head.encoding = input.ConsumeIntegralInRange<std::uint16_t>(0, 4);
    head.first_scan = input.ConsumeBool() ? input.ConsumeIntegralInRange<std::int64_t>(0, 300)
                                          : input.ConsumeIntegral<std::int64_t>();
    head.time_ns = input.ConsumeIntegral<std::int64_t>();
    const std::size_t place = bytes.size();
    append(bytes, head, input.ConsumeRandomLengthString());
    if (input.ConsumeIntegralInRange<int>(0, 7) == 0) {
      const std::size_t entry_size = bytes.size() - place;
      bytes[place + input.ConsumeIntegralInRange<std::size_t>(0, entry_size - 1)] ^= 1;
    }
  }
  test::write_content(name, bytes);
  const auto reading = record::read_journal(name);
  STICKSLIP_EXPECTS(reading || reading.error().message.find('\n') == std::string::npos);
  static_cast<void>(record::judge(name));
  if (!reading) return 0;
  STICKSLIP_EXPECTS(reading->damaged_size() <= reading->file_size && reading->file_size == bytes.size());
  STICKSLIP_EXPECTS(reading->record.scan.size() == reading->scan_count &&
                    reading->record.raw.size() == reading->scan_count);
  STICKSLIP_EXPECTS(std::ranges::adjacent_find(reading->record.scan, std::greater_equal<>{}) ==
                    reading->record.scan.end());
  std::size_t count = 0;
  const record::JournalScanSource source{name, *reading};
  source.for_each_piece([&](const record::ScanPiece& piece) { count += piece.raw.size(); });
  STICKSLIP_EXPECTS(count == reading->scan_count);
  if (source.has_force()) source.for_each_force_piece([](std::span<const double>) {});
  if (source.has_second()) source.for_each_second_piece([](std::span<const std::int32_t>) {});
  return 0;
}

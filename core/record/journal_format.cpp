#include "core/record/journal_format.hpp"

#include <fmt/format.h>

#include <cstring>

#include <boost/crc.hpp>

namespace stickslip::record {
namespace {

using Crc32c = boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true>;

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes) {
  Crc32c crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

std::uint32_t entry_crc(EntryHead head, std::span<const std::byte> payload) {
  head.crc = 0;
  Crc32c crc;
  crc.process_bytes(&head, sizeof head);
  crc.process_bytes(payload.data(), payload.size());
  return crc.checksum();
}

std::optional<Entry> first_entry(std::span<const std::byte> bytes, std::string& why) {
  Entry entry;
  if (bytes.size() < kEntryHeadSize) {
    why = "torn entry";
    return std::nullopt;
  }
  std::memcpy(&entry.head, bytes.data(), kEntryHeadSize);
  if (entry.head.magic != EntryHead{}.magic) {
    why = "no entry where one should begin";
    return std::nullopt;
  }
  if (entry.head.payload_size > bytes.size() - kEntryHeadSize) {
    why = "torn entry";
    return std::nullopt;
  }
  entry.payload = bytes.subspan(kEntryHeadSize, entry.head.payload_size);
  if (entry_crc(entry.head, entry.payload) != entry.head.crc) {
    why = "entry with a wrong checksum";
    return std::nullopt;
  }
  return entry;
}

}  // namespace stickslip::record

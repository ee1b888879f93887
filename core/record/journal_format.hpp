/// \file
/// One entry of a journal, as bytes. Little-endian, as every machine this runs on:
///
///     0 magic "SSJ1" · 4 type u16 · 6 encoding u16 · 8 payload size u32 · 12 CRC-32C u32
///     16 first scan i64 · 24 time i64 [ns, monotonic] · 32 payload
///
/// The first scan is 0 in entries of kHeader, kSpikes and kEnd; the time is 0 except in those of kScans and
/// kAnchor. The CRC covers the head, its CRC taken as 0, and the payload.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace stickslip::record {

static_assert(std::endian::native == std::endian::little, "journals are little-endian");

enum class EntryType : std::uint16_t {
  kHeader = 1,     ///< JSON.
  kScans = 2,      ///< Consecutive raw values in the entry's encoding.
  kSpikes = 3,     ///< Scan indices, i64.
  kGap = 4,        ///< JSON.
  kCycle = 5,      ///< JSON.
  kAnchor = 6,     ///< Two i64: monotonic and real time, ns; the scan is in the head.
  kEvent = 7,      ///< JSON.
  kEnd = 8,        ///< JSON, a zero byte and the tables as f64, row by row: cycles, true modes, true cycles.
  kTrueForce = 9,  ///< f64: the noise-free coefficient of consecutive scans.
  kSecond = 10,    ///< i32: codes of the second channel of consecutive scans, −1 where none came.
};

/// Number type of the payload of kScans, and kF64 of kTrueForce. Other types of entries have kNone and one
/// format each.
enum class Encoding : std::uint16_t { kNone = 0, kU16 = 1, kU32 = 2, kF64 = 3 };

struct EntryHead {
  std::array<char, 4> magic{'S', 'S', 'J', '1'};
  std::uint16_t type = 0;
  std::uint16_t encoding = 0;
  std::uint32_t payload_size = 0;
  std::uint32_t crc = 0;
  std::int64_t first_scan = 0;
  std::int64_t time_ns = 0;
};
inline constexpr std::size_t kEntryHeadSize = 32;
static_assert(sizeof(EntryHead) == kEntryHeadSize);

/// CRC-32C [Castagnoli 1993; RFC 3720, 12.1].
[[nodiscard]] std::uint32_t crc32c(std::span<const std::byte> bytes);

/// CRC-32C of a head, its crc field taken as 0, and its payload.
[[nodiscard]] std::uint32_t entry_crc(EntryHead head, std::span<const std::byte> payload);

struct Entry {
  EntryHead head;
  std::span<const std::byte> payload;
};

/// The entry at the start of `bytes`, which its payload refers to. Nullopt, with `why` set, if no complete
/// entry with a right checksum begins there.
[[nodiscard]] std::optional<Entry> first_entry(std::span<const std::byte> bytes, std::string& why);

}  // namespace stickslip::record

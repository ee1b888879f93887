/// \file
/// Scan block, the unit that travels from the board to the detector: consecutive scans of one or two
/// channels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/scan_index.hpp"

namespace stickslip::daq {

using base::ScanIndex;

/// Clock readings taken right after the read that delivered a block.
struct ClockStamp {
  std::int64_t monotonic_ns = 0;
  std::int64_t realtime_ns = 0;
  /// True if the read waited for the scans, so that the stamp is the time of the last one. False while a
  /// backlog is read. A replay always sets it.
  bool prompt = true;
};

/// Consecutive scans, oldest first. Plain data: copied through the ring without allocation.
struct ScanBlock {
  static constexpr std::size_t kMaxScans = 64;

  ScanIndex first = 0;      ///< Index of raw[0].
  std::uint32_t count = 0;  ///< Scans in use, 0 … kMaxScans.
  ClockStamp stamp;
  // Totals of the acquisition up to this block; their increase since the block before is the cause of a jump
  // between the two. The acquisition thread sets them, not the board.
  std::uint64_t overrun_count = 0;       ///< Halts of the board.
  std::uint64_t suspend_count = 0;       ///< Suspends of the computer.
  std::uint64_t dropped_scan_count = 0;  ///< Scans dropped by a full ring.
  /// Raw readings: A/D counts (a double holds every count of up to 53 bits exactly), or the values of a trace
  /// that was imported, or simulated without a converter; BoardInfo::quantity tells which, and their unit.
  std::array<double, kMaxScans> raw{};
  bool has_second = false;  ///< Whether the board has a second channel; the same in all its blocks.
  /// Codes of the second channel; SecondChannel::kNoCode for a missing one.
  std::array<std::int32_t, kMaxScans> second{};

  [[nodiscard]] ScanIndex end() const noexcept { return first + static_cast<ScanIndex>(count); }
  [[nodiscard]] std::span<const double> scans() const noexcept { return {raw.data(), count}; }
  /// As many codes as scans(); none without a second channel.
  [[nodiscard]] std::span<const std::int32_t> second_codes() const noexcept {
    return {second.data(), has_second ? count : 0};
  }
};

}  // namespace stickslip::daq

/// \file
/// The file of a sweep: arrays over the grid, as NeXus groups that viewers plot without being asked.
/// The layout is described in docs/sweep.md.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/result.hpp"
#include "core/record/sweep.hpp"

namespace stickslip::record {

inline constexpr std::string_view kSweepFormat = "stickslip-sweep";
inline constexpr std::int64_t kSweepFormatVersion = 1;

/// Writes the file at `path`, which must not exist (kUsage): built as PATH.tmp, made durable, renamed. On
/// any error no file is left. Equal sweeps are equal files, byte for byte: it holds no date and no time.
/// Starts no threads.
[[nodiscard]] base::Result<void> publish_sweep(const SweepFacts& facts, const SweepTable& table,
                                               const std::filesystem::path& path);

}  // namespace stickslip::record

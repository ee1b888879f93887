/// \file
/// HDF5 file of a sweep: arrays over the grid, in NeXus groups, which viewers of NeXus plot. The layout is
/// described in docs/sweep.md.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/result.hpp"
#include "core/record/sweep.hpp"

namespace stickslip::record {

inline constexpr std::string_view kSweepFormat = "stickslip-sweep";
inline constexpr std::int64_t kSweepFormatVersion = 1;

/// Writes the file at `path`, which must not exist (kUsage): built as PATH.UUID.tmp, synced, renamed. Other
/// errors: kFailure. An error leaves no file, except when only the last step fails, the sync of the folder.
/// Equal sweeps give equal files, byte for byte: without dates and times. Starts no threads.
/// \param table  of facts.run_count() runs.
[[nodiscard]] base::Result<void> publish_sweep(const SweepFacts& facts, const SweepTable& table,
                                               const std::filesystem::path& path);

}  // namespace stickslip::record

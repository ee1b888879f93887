/// \file
/// From a journal to the finished file: built whole beside it, verified, published by one rename.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

/// Evaluates a test whose journal has no end: the analysis lives above this folder.
using Evaluate = std::function<EndRecord(const Record&)>;

/// Of a journal that stays beside its record because some of it could not be read: NAME.journal.damaged.
/// Nobody takes it for a journal that waits for its record.
inline constexpr std::string_view kDamagedExtension = ".damaged";

/// The finished file of a journal, damaged or not: beside it, with the extension .h5.
[[nodiscard]] std::filesystem::path record_of(const std::filesystem::path& journal);

struct Finalised {
  std::filesystem::path file;
  std::int64_t scan_count = 0;  ///< In the file.
  std::uint64_t damaged_size =
      0;                       ///< Bytes of the journal that could not be read; a torn end is none of them.
  std::filesystem::path kept;  ///< Where the journal stays; empty: it was removed.
};

/// Builds TEST.h5 from TEST.journal and then removes the journal. Takes the memory of the tables and 32 bytes
/// for each entry of the journal (half a byte a scan in blocks of 64), not that of the scans; a test that is
/// to be evaluated excepted. On any error nothing but the journal is left. A file that stands there already
/// is never written again: if it holds the same scans the journal is removed, if not it is an error.
///
/// A journal that is damaged, or torn with fewer scans than expected, is not removed but renamed to
/// TEST.journal.damaged; one of that name stays where it is. Its record holds all that can be read, is
/// incomplete or interrupted, and says what is missing.
///
/// Meant for a process of its own: HDF5 has one global lock and its errors can be fatal. Starts no
/// threads.
/// \param evaluate  asked if the journal has no end, or its end knew more scans than are left; without it
/// such a test
///                  gets no results, with the reason "interrupted" or "damaged". The status of a test without
///                  end is "interrupted" either way.
/// \param longest  to wait for somebody else who finishes the journal.
/// \param expected_scans  as many as were written; nothing if nobody knows. A record with fewer says so.
/// Errors: kUsage if the file is no journal, else kFailure.
[[nodiscard]] base::Result<Finalised> finalise(const std::filesystem::path& journal,
                                               const Evaluate& evaluate = {},
                                               const FileCalls& calls = system_calls(),
                                               std::chrono::milliseconds longest = {},
                                               std::optional<std::int64_t> expected_scans = {});

/// Whether a record can be made at `path`: nothing stands there (kUsage), its folder does (kUsage).
[[nodiscard]] base::Result<void> check_publishable(const std::filesystem::path& path);

/// Writes a whole record at `path`, which must not exist (kUsage): built as PATH.part, compared
/// with `record` scan for scan, made durable, renamed. On any error no file is left.
/// \param record  has an end.
[[nodiscard]] base::Result<void> publish_record(const Record& record, const std::filesystem::path& path);

/// As publish_record(), but the scans come piece by piece from the journal, which stays where it is.
/// \param record  all but the scans.
[[nodiscard]] base::Result<void> publish_journal(const std::filesystem::path& journal, const Record& record,
                                                 const std::filesystem::path& path);

}  // namespace stickslip::record

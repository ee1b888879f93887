/// \file
/// Finaliser: turns a journal into an HDF5 record. The file is built beside the journal, verified, and
/// published by one rename.
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
#include "core/record/scan_source.hpp"

namespace stickslip::record {

/// Evaluates a test whose journal has no end. A callback, since this folder must not include the analysis.
using Evaluate = std::function<EndRecord(const Record&)>;

/// Extension of a partly unreadable journal that stays beside its record: NAME.journal.damaged. It is not
/// finalised again.
inline constexpr std::string_view kDamagedExtension = ".damaged";

/// Path of a journal's record: in the same folder, with the extension .h5.
[[nodiscard]] std::filesystem::path record_of(const std::filesystem::path& journal);

/// Result of finalise().
struct Finalised {
  std::filesystem::path file;
  std::int64_t scan_count = 0;     ///< Scans in the record.
  std::uint64_t damaged_size = 0;  ///< Unreadable bytes of the journal, without a torn end.
  std::filesystem::path kept;      ///< Path of the journal if it was not removed.
};

/// Builds TEST.h5 from TEST.journal and then removes the journal. Memory is that of the tables and 32 bytes
/// for each entry of the journal (half a byte a scan in blocks of 64); scans are in memory only if the test
/// must be evaluated. After an error only the journal is left. An existing TEST.h5 is never overwritten: if
/// it holds the same scans the journal is removed, otherwise it is an error.
///
/// A damaged journal, or one with a torn end and fewer scans than expected, is renamed to
/// TEST.journal.damaged instead of removed. Its record holds all readable data, has the status incomplete or
/// interrupted, and names what is missing.
///
/// Run it in a process of its own: HDF5 has one global lock and its errors can be fatal. Only `evaluate` may
/// start threads.
/// \param evaluate  asked if the journal has no end, or its end knew more scans than are left; without it
/// such a test
///                  gets no results, with the reason "interrupted" or "damaged". The status of a test without
///                  end is "interrupted" either way.
/// \param longest  time to wait for another process that holds the journal.
/// \param expected_scans  scans written to the journal; nullopt if unknown. A record with fewer reports it.
/// Errors: kUsage if the file is not a journal, else kFailure.
[[nodiscard]] base::Result<Finalised> finalise(const std::filesystem::path& journal,
                                               const Evaluate& evaluate = {},
                                               const FileCalls& calls = system_calls(),
                                               std::chrono::milliseconds longest = {},
                                               std::optional<std::int64_t> expected_scans = {});

/// Checks that a record can be created at `path`. Errors: kUsage if the path exists or its folder does not.
[[nodiscard]] base::Result<void> check_publishable(const std::filesystem::path& path);

/// Writes a whole record at `path`, which must not exist (kUsage): built as PATH.part, compared
/// with `record` scan for scan, made durable, renamed. On any error no file is left.
/// \param record  has an end.
[[nodiscard]] base::Result<void> publish_record(const Record& record, const std::filesystem::path& path);

/// The same, with scans that are not in the record.
/// \param record  everything except the scans.
[[nodiscard]] base::Result<void> publish_record(const Record& record, const ScanSource& scans,
                                                const std::filesystem::path& path);

/// The same, with an end that is computed in another thread while the scans are written. Returns its error
/// and throws what it throws, without a file. \param record  everything except the scans; its end tells when
/// the test ended, and is replaced by set_end(). \param evaluate  must not use HDF5, nor `scans`: see
/// ColumnScans::view().
[[nodiscard]] base::Result<void> publish_record(Record& record, const ScanSource& scans,
                                                const std::filesystem::path& path,
                                                const std::function<base::Result<EndRecord>()>& evaluate);

/// As publish_record(), but the scans come piece by piece from the journal, which stays where it is.
/// \param record  everything except the scans.
[[nodiscard]] base::Result<void> publish_journal(const std::filesystem::path& journal, const Record& record,
                                                 const std::filesystem::path& path);

}  // namespace stickslip::record

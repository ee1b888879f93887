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

/// Evaluates a test from its record, which holds the scans in memory. A callback, since this folder must not
/// include the analysis.
using Evaluate = std::function<EndRecord(const Record&)>;

/// Extension of a partly unreadable journal that stays beside its record: NAME.journal.damaged, or
/// NAME.journal.2.damaged … if that name is taken. Folders are searched for kJournalExtension only, and so it
/// is not finalised again.
inline constexpr std::string_view kDamagedExtension = ".damaged";

/// Path of a journal's record, in the same folder: NAME.h5 for NAME.journal, NAME.journal.damaged and
/// NAME.journal.2.damaged. Any other extension is replaced too.
[[nodiscard]] std::filesystem::path record_of(const std::filesystem::path& journal);

/// Result of finalise().
struct Finalised {
  std::filesystem::path file;
  std::int64_t scan_count = 0;     ///< Scans in the record.
  std::uint64_t damaged_size = 0;  ///< Unreadable bytes of the journal, without a torn end.
  std::filesystem::path kept;      ///< Path of the journal if it was not removed; else empty.
};

/// Builds TEST.h5 from TEST.journal and then removes the journal. Memory is that of the tables and 32 bytes
/// for each entry of the journal (half a byte a scan in blocks of 64); scans are in memory only if the test
/// must be evaluated. After an error the data are in the journal, in TEST.h5 or in both; no partial record is
/// left. An existing TEST.h5 is never overwritten unless it is empty: if it holds the same scans it counts as
/// built, otherwise it is an error.
///
/// A damaged journal, or one with a torn end and fewer scans than expected, is renamed to
/// TEST.journal.damaged instead of removed; one that ends in .damaged already keeps its name. Its record
/// holds all readable data, has the status incomplete or interrupted, and names what is missing. A torn end
/// alone is dropped; a complete test then has the status recovered.
///
/// Run it in a process of its own: HDF5 has one global lock and its errors can be fatal. It starts no
/// threads; `evaluate` may.
/// \param evaluate  called if the journal has no end, is damaged, or has fewer scans than expected; its
///        exceptions pass through. Of a test with an end it replaces results, cycles and spikes. Without it
///        cycles and spikes are the journal's, and the results of such a test are absent, with the reason
///        "interrupted" (no end) or "damaged". A test without end has the status interrupted and the cause
///        kProgramDied either way.
/// \param longest  time to wait for another process that holds the journal.
/// \param expected_scans  scans written to the journal; nullopt if unknown. A record with fewer says so in
///        its reasons, and has the status incomplete or interrupted.
/// Errors: kUsage as JournalLock::take() and read_journal(), so also for an empty journal
/// (remove_if_empty()); else kFailure.
[[nodiscard]] base::Result<Finalised> finalise(const std::filesystem::path& journal,
                                               const Evaluate& evaluate = {},
                                               const FileCalls& calls = system_calls(),
                                               std::chrono::milliseconds longest = {},
                                               std::optional<std::int64_t> expected_scans = {});

/// Checks, before long work, that nothing is at `path` and that its folder exists. Errors: kUsage.
[[nodiscard]] base::Result<void> check_publishable(const std::filesystem::path& path);

/// Writes a whole record at `path`, which must not exist (kUsage): built as PATH.part, in place of any file
/// of that name, made durable, compared with `record` scan for scan, renamed. Other errors: kFailure. An
/// error leaves no file, except when only the last step fails, the sync of the folder.
/// \param record  has an end, and columns of equal length, of which true_coefficient and second may be empty
///        (contract). Counts without a load cell are an error.
[[nodiscard]] base::Result<void> publish_record(const Record& record, const std::filesystem::path& path);

/// Writes a record whose scans come from `scans`; otherwise as publish_record(record, path).
/// \param record  everything except the scans, with an end (contract).
[[nodiscard]] base::Result<void> publish_record(const Record& record, const ScanSource& scans,
                                                const std::filesystem::path& path);

/// Writes a record as publish_record(record, scans, path) does, while `evaluate` computes its end in another
/// thread. If `evaluate` fails, returns its error or throws its exception, and leaves no file.
/// \param record  everything except the scans. It needs an end (contract), of which only end_realtime_ns is
///        stored; set_end() then replaces it by that of `evaluate`. After an error it may have either.
/// \param evaluate  uses neither HDF5 nor `scans`; ColumnScans::view() gives it the same scans.
[[nodiscard]] base::Result<void> publish_record(Record& record, const ScanSource& scans,
                                                const std::filesystem::path& path,
                                                const std::function<base::Result<EndRecord>()>& evaluate);

/// Writes a record whose scans come piece by piece from the journal, which is neither locked nor removed;
/// otherwise as publish_record(record, path). Errors also as read_journal(), and kFailure if any byte of the
/// journal is unreadable, those of a torn end included.
/// \param record  everything except the scans, with an end (contract).
[[nodiscard]] base::Result<void> publish_journal(const std::filesystem::path& journal, const Record& record,
                                                 const std::filesystem::path& path);

}  // namespace stickslip::record

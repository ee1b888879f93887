/// \file
/// Writer and reader of journals. A journal is the append-only file that a test is written to while it runs;
/// the daemon writes it by PatientJournal.
///
///     auto journal = JournalWriter::create(folder / "TEST.journal", header);
///     journal->append_scans(first, raw, stamp);  // every 0.1 s
///     journal->sync();                           // once a second
///     journal->append_end(end);
///
/// Each entry is a 32-byte head and its payload under one CRC-32C, so that a reader can tell complete entries
/// from torn ones. Measured: kill -9 loses nothing that was written, and a power cut nothing that was synced;
/// HDF5 written live loses both. Layout of an entry: docs/record-file.md.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/entry_builder.hpp"
#include "core/record/journal_entries.hpp"
#include "core/record/journal_file.hpp"
#include "core/record/journal_format.hpp"
#include "core/record/record.hpp"
#include "core/record/scan_source.hpp"

namespace stickslip::record {

inline constexpr std::string_view kJournalExtension = ".journal";
/// Extension of the record.
inline constexpr std::string_view kRecordExtension = ".h5";

/// Writes a journal, each entry at once to the file. Not thread-safe. Move-only. Destruction closes without
/// syncing.
class JournalWriter {
 public:
  /// Creates the file, which must not exist, locks it (journal_care.hpp), writes the header and makes file
  /// and name durable. A header without uuid gets one. Errors: kFailure; its file is then removed if
  /// possible, unless another process has locked it.
  /// \param header  has a load cell if the board gives counts (contract).
  /// \param calls  must outlive the journal.
  [[nodiscard]] static base::Result<JournalWriter> create(const std::filesystem::path& path,
                                                          RecordHeader header,
                                                          const FileCalls& calls = system_calls());

  // Every append either adds a complete entry, or returns an error (kFailure), adds none, and can be
  // repeated.

  /// \param first  not before the end of the scans written so far (contract).
  /// \param raw  consecutive, not empty; counts are whole numbers in 0 … maxdata (contract).
  /// \param stamp  only its monotonic time is stored.
  [[nodiscard]] base::Result<void> append_scans(daq::ScanIndex first, std::span<const double> raw,
                                                const daq::ClockStamp& stamp);
  /// The noise-free force of consecutive scans that are in the journal already (model::TrueForce); NaN where
  /// unknown. \param first  as in EntryBuilder::true_coefficients().
  [[nodiscard]] base::Result<void> append_true_coefficients(daq::ScanIndex first,
                                                            std::span<const double> coefficient);
  /// Codes of the second channel, daq::SecondChannel::kNoCode where none came. Otherwise as
  /// append_true_coefficients().
  /// \param codes  kNoCode … maxdata of the header's board.second; read_journal() takes others, and any
  ///        without board.second, for damage.
  [[nodiscard]] base::Result<void> append_second(daq::ScanIndex first, std::span<const std::int32_t> codes);
  [[nodiscard]] base::Result<void> append_spikes(std::span<const daq::ScanIndex> spikes);
  [[nodiscard]] base::Result<void> append_gap(const daq::Gap& gap);
  [[nodiscard]] base::Result<void> append_cycle(const detect::Cycle& cycle);
  [[nodiscard]] base::Result<void> append_anchor(const ClockAnchor& anchor);
  [[nodiscard]] base::Result<void> append_event(const Event& event);
  /// The last entry. Once this object is destroyed, finalise() can take the journal.
  [[nodiscard]] base::Result<void> append_end(const EndRecord& end);

  /// As JournalFile::sync(): after a failure data may be lost, even if a later call succeeds. PatientJournal
  /// writes them again.
  [[nodiscard]] base::Result<void> sync();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return file_.path(); }
  /// Bytes in whole entries.
  [[nodiscard]] std::uint64_t size() const noexcept { return file_.size(); }

 private:
  JournalWriter(JournalFile file, EntryBuilder builder)
      : file_(std::move(file)), builder_(std::move(builder)) {}

  JournalFile file_;
  EntryBuilder builder_;
};

/// Run of consecutive scans of a journal.
struct ScanRun {
  daq::ScanIndex first = 0;
  std::size_t count = 0;
  std::size_t row = 0;  ///< Number of the journal's scans before it.

  [[nodiscard]] daq::ScanIndex end() const noexcept { return first + static_cast<daq::ScanIndex>(count); }
};

/// Position of an entry with values of consecutive scans.
struct EntryPlace {
  std::uint64_t position = 0;  ///< Byte of the file.
  std::uint64_t size = 0;      ///< Bytes, head included.
  daq::ScanIndex first = 0;
  std::size_t count = 0;

  [[nodiscard]] daq::ScanIndex end() const noexcept { return first + static_cast<daq::ScanIndex>(count); }
};

/// Content of a journal: all complete and valid entries. Cycles and events are in the order of the file, all
/// others in the order of their scans. If the journal has an end, cycles and spikes are the end's.
struct JournalReading {
  std::int64_t format_version = kFormatVersion;  ///< The header's.
  /// With JournalScans::kCount its scan, raw, second and true_coefficient are empty. Scans missing between
  /// two runs without a gap entry become gaps with the cause unknown if why_unread() is empty, else damaged.
  Record record;
  std::size_t scan_count = 0;
  std::vector<ScanRun> runs;  ///< All scans, rising.
  // Places of the entries, rising and without overlap.
  std::deque<EntryPlace> scans;
  std::deque<EntryPlace> true_coefficients;
  std::deque<EntryPlace> second_codes;
  std::uint64_t file_size = 0;
  std::vector<UnreadBytes> damaged;     ///< Unreadable bytes and invalid entries, in the order of position.
  std::optional<UnreadBytes> torn_end;  ///< Incomplete end of the file, as after a stop.

  /// Number of bytes in `damaged`; torn_end does not count.
  [[nodiscard]] std::uint64_t damaged_size() const noexcept;
  /// Reason of the first of `damaged`, else of torn_end; empty if there is neither.
  [[nodiscard]] std::string why_unread() const;
};

/// Whether read_journal() keeps the scans in memory or only counts them.
enum class JournalScans { kKeep, kCount };

/// Reads every complete entry, without a lock. Memory is that of the tables, 32 bytes for each entry, and
/// with kKeep that of the scans. Errors: kFailure if the file cannot be read, or if its header is damaged but
/// complete entries follow; kUsage if there is no such regular file, no complete entry in it, or a whole
/// header that this program cannot read.
[[nodiscard]] base::Result<JournalReading> read_journal(const std::filesystem::path& path,
                                                        JournalScans scans = JournalScans::kKeep,
                                                        const FileCalls& calls = system_calls());

/// Source of a journal's scans, read from disk. Throws std::runtime_error if the file cannot be read, or
/// an entry is no longer where read_journal() found it.
class JournalScanSource final : public ScanSource {
 public:
  /// \param reading  of this journal; must outlive the object, as must `calls`.
  JournalScanSource(std::filesystem::path path, const JournalReading& reading,
                    const FileCalls& calls = system_calls())
      : path_(std::move(path)), reading_(reading), calls_(calls) {}

  [[nodiscard]] std::size_t size() const override { return reading_.scan_count; }
  [[nodiscard]] std::int64_t extent() const override {
    return reading_.runs.empty() ? 0 : reading_.runs.back().end() - reading_.runs.front().first;
  }
  void for_each_piece(const std::function<void(const ScanPiece&)>& use) const override;
  [[nodiscard]] bool has_force() const override { return !reading_.true_coefficients.empty(); }
  void for_each_force_piece(const std::function<void(std::span<const double>)>& use) const override;
  [[nodiscard]] bool has_second() const override { return !reading_.second_codes.empty(); }
  void for_each_second_piece(const std::function<void(std::span<const std::int32_t>)>& use) const override;

 private:
  void for_each_entry(const std::deque<EntryPlace>& places,
                      const std::function<void(const Entry&)>& use) const;
  /// Values of a column from those entries, in the same pieces as the scans.
  template <typename Value>
  void for_each_column_piece(const std::deque<EntryPlace>& places, Value absent,
                             const std::function<void(std::span<const Value>)>& use) const;

  std::filesystem::path path_;
  const JournalReading& reading_;
  const FileCalls& calls_;
};

}  // namespace stickslip::record

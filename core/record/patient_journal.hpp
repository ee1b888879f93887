/// \file
/// Journal buffered in memory. The storage thread adds entries and never accesses the disk. The disk thread
/// writes them, and repeats and reports failed writes.
///
///     PatientJournal journal{path, header, memory};      // touches no file
///     journal.add_scans(first, raw, stamp);               // storage thread: into memory
///     if (const auto trouble = journal.save()) …          // disk thread: written and synced, or why not
///
/// If the file or its folder is removed or renamed, save() writes the journal again, from the open file.
///
/// Entries that do not fit into memory are lost, except gaps and the end. Lost scans become a gap with the
/// cause storage-full.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/record/entry_builder.hpp"
#include "core/record/journal_file.hpp"

namespace stickslip::record {

/// Journal of one test, for two threads: one adds, one writes.
class PatientJournal {
 public:
  /// \param path  created with its folders at the first write; under another name if a journal or record of
  ///        this name then exists (journal_name.hpp).
  /// \param header  gets a uuid if it has none; must have a load cell if the board gives counts (contract).
  /// \param memory  limit of waiting_size(), bytes, beyond which entries are lost. Entries written since the
  ///        last sync are kept in memory too, but do not count.
  /// \param calls  must outlive the journal.
  PatientJournal(std::filesystem::path path, RecordHeader header, std::size_t memory,
                 const FileCalls& calls = system_calls());

  // For the storage thread. Contracts as in EntryBuilder. \return false if it is lost for lack of memory.

  /// \param second  codes of the second channel, one for each scan; empty if there is no such channel.
  bool add_scans(daq::ScanIndex first, std::span<const double> raw, const daq::ClockStamp& stamp,
                 std::span<const std::int32_t> second = {});
  /// Of kept scans only: read_journal() takes values of which no scan is in the journal for damage.
  bool add_true_coefficients(daq::ScanIndex first, std::span<const double> coefficient);
  bool add_cycle(const detect::Cycle& cycle);
  bool add_anchor(const ClockAnchor& anchor);
  bool add_event(const Event& event);
  /// Added even if memory is full.
  void add_gap(const daq::Gap& gap);
  /// The last entry; added even if memory is full. If scans were lost, its status becomes incomplete and
  /// their number is added to its reasons.
  void add_end(EndRecord end);
  /// Blocks until half of the memory is free, at most `longest`. \return whether it is.
  bool wait_for_room(std::chrono::milliseconds longest) const;

  // For any thread.

  [[nodiscard]] std::int64_t kept_scan_count() const;  ///< Scans added so far, without the lost ones.
  [[nodiscard]] std::int64_t lost_scan_count() const;  ///< Scans lost so far for lack of memory.
  /// Bytes of entries in memory: not written yet, or to be written again after a failed sync.
  [[nodiscard]] std::size_t waiting_size() const;

  /// Present or future path; differs from the constructor's if that was occupied.
  [[nodiscard]] std::filesystem::path path() const;

  // For the disk thread. \return reason of a failure; unwritten data stay buffered. Nullopt: done.

  /// Writes the buffered entries, without a sync. Creates the file first, if there is none yet.
  [[nodiscard]] std::optional<std::string> write();
  /// ensure_at_path(), write() and a sync. After a failed sync the next call writes again all data since the
  /// last successful one.
  [[nodiscard]] std::optional<std::string> save();
  /// Checks that the path leads to the journal. If not, writes it again, under another name if the path is
  /// occupied. After hand_over(), an existing record suffices. Does nothing before the file is created.
  [[nodiscard]] std::optional<std::string> ensure_at_path();
  /// Number of times that the journal was written again.
  [[nodiscard]] int anew_count() const noexcept { return anew_count_; }
  /// Whether all entries are written and synced; false before the file is created. Whether the path still
  /// leads to the file is not looked at.
  [[nodiscard]] bool saved() const { return file_ && unsynced_.empty() && waiting_size() == 0; }
  /// Releases the disk space reserved beyond the last entry, for example for the record.
  void give_room_back();
  /// After the last entry was saved: give_room_back(), then releases the lock, so that another process can
  /// finalise the journal. The file stays open, to be written again if it disappears before.
  void hand_over();

 private:
  struct LostScans {
    daq::ScanIndex first;
    std::int64_t count;
  };

  [[nodiscard]] bool has_room(std::size_t size) const;
  void keep(EntryBuilder::Bytes entry);
  bool keep_if_room(EntryBuilder::Bytes entry);
  void tell_lost();
  [[nodiscard]] std::optional<std::string> open();
  [[nodiscard]] std::optional<std::string> write_anew();
  void move_to(const std::filesystem::path& path);

  const FileCalls* calls_;
  std::size_t memory_;

  // Adding.
  EntryBuilder builder_;
  std::vector<LostScans> lost_;  ///< Not yet reported by a gap.

  mutable std::mutex mutex_;  ///< Of the members up to the next comment.
  mutable std::condition_variable taken_;
  std::filesystem::path path_;
  std::vector<std::byte> waiting_;
  std::size_t in_hand_ = 0;  ///< Bytes taken out to be written.
  std::int64_t kept_count_ = 0;
  std::int64_t lost_count_ = 0;

  // Writing.
  std::vector<std::byte> header_;
  std::optional<JournalFile> file_;
  std::vector<std::byte> unsynced_;  ///< Written since the last sync that succeeded.
  std::uint64_t synced_size_ = 0;
  int anew_count_ = 0;
  bool handed_over_ = false;
};

}  // namespace stickslip::record

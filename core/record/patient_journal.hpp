/// \file
/// A journal that waits for the disk. Who records hands entries over and never meets the disk; who owns the
/// disk writes what waits, tries again where it was refused, and says so.
///
///     PatientJournal journal{path, header, memory};      // touches no file
///     journal.add_scans(first, raw, stamp);               // storage thread: into memory
///     if (const auto trouble = journal.settle()) …        // disk thread: onto the disk and synced, or why
///     not
///
/// A journal whose path does not lead to it any more, because somebody removed or renamed it or its folder,
/// is written anew from the open file.
///
/// What does not fit into the memory is lost: scans become a gap with the cause storage-full.
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

/// Two threads: one adds, one writes.
class PatientJournal {
 public:
  /// \param path  made with its folders when it is first written; if something stands there then, under
  /// another name (journal_name.hpp).
  /// \param memory  bytes of entries that may wait. \param calls  outlive the journal.
  PatientJournal(std::filesystem::path path, RecordHeader header, std::size_t memory,
                 const FileCalls& calls = system_calls());

  // The thread that adds. Contracts as in EntryBuilder. \return false: lost for want of memory.

  /// \param second  codes of the second channel: as many, or none if there is no such channel.
  bool add_scans(daq::ScanIndex first, std::span<const double> raw, const daq::ClockStamp& stamp,
                 std::span<const std::int32_t> second = {});
  bool add_true_coefficients(daq::ScanIndex first, std::span<const double> coefficient);
  bool add_cycle(const detect::Cycle& cycle);
  bool add_anchor(const ClockAnchor& anchor);
  bool add_event(const Event& event);
  /// Kept whatever the memory.
  void add_gap(const daq::Gap& gap);
  /// The last entry, kept whatever the memory. Its status becomes incomplete if scans were lost.
  void add_end(EndRecord end);
  /// Waits, at most so long, until half of the memory is free. \return whether it is.
  bool wait_for_room(std::chrono::milliseconds longest) const;

  /// Scans that were kept so far, and those that were lost for want of memory. Any thread, as the next.
  [[nodiscard]] std::int64_t kept_scan_count() const;
  [[nodiscard]] std::int64_t lost_scan_count() const;
  /// Bytes that are not on the disk yet.
  [[nodiscard]] std::size_t waiting_size() const;

  /// Where it stands or will stand; another name once something else stood at its path.
  [[nodiscard]] std::filesystem::path path() const;

  // The thread that writes. \return why not all could be done; what was refused is kept.

  [[nodiscard]] std::optional<std::string> write();
  /// The same, and makes it durable. What an fsync refused is written again.
  [[nodiscard]] std::optional<std::string> settle();
  /// Sees to it that the path leads to the journal: one that is gone is written anew, beside what stands
  /// there now. Of a journal that was handed over, its record stands for it.
  [[nodiscard]] std::optional<std::string> stay();
  /// Times that it was written anew.
  [[nodiscard]] int anew_count() const noexcept { return anew_count_; }
  /// Whether settle() has nothing to do. A journal that is not on the disk yet has its header to write.
  [[nodiscard]] bool settled() const { return file_ && unsynced_.empty() && waiting_size() == 0; }
  /// After the last entry: the room that was reserved behind the end is free for others, such as the record.
  void give_room_back();
  /// After it: others may finish the journal. It stays open, to be written anew if it vanishes before.
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
  std::vector<LostScans> lost_;  ///< Not yet told by a gap.

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

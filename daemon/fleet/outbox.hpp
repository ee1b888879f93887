/// \file
/// The outbox: an ordered, bounded queue of results for the broker. Each result is a file until the broker
/// has acknowledged it, so that it survives an absent broker and the end of the daemon.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::fleet {

/// The result of one test, as sent to the broker.
struct FleetResult {
  std::string record;          ///< Name of the record, without folder and extension.
  std::string id;              ///< The record's entry_identifier_uuid.
  std::string payload;         ///< JSON.
  std::uint64_t sequence = 0;  ///< Position in the order of add(); set by the outbox.
};

/// Thread-bound; blocks on the disk. Sequence numbers in the file names define the order, not a clock. The
/// folder also holds the file `told`, with the name of every record ever added, one a line. Records not named
/// there were never sent (backlog.hpp).
class Outbox {
 public:
  /// Reads the results that an earlier program left. If the folder cannot be made or read, results stay in
  /// memory. \param most  capacity, results.
  Outbox(std::filesystem::path folder, std::size_t most);

  struct Added {
    bool is_new = false;   ///< False: the outbox holds it already.
    bool dropped = false;  ///< The oldest result was dropped to make room.
  };
  Added add(FleetResult result);
  /// Removes a result that the broker has acknowledged. \return false if it is not in the outbox.
  bool remove(const std::string& id);

  [[nodiscard]] const std::deque<FleetResult>& results() const noexcept { return results_; }
  /// Number of results in memory only, because the disk refused them.
  [[nodiscard]] std::size_t unsaved_count() const noexcept { return unsaved_; }
  /// The records that were never added, in the given order. A new outbox takes all present records as added.
  /// An outbox of an earlier version has a file `newest` instead of `told`, with the name of the latest
  /// record sent. Records up to that name count as added; none do if that name lies in the future. \param
  /// records  all present records. \param now  name that a record would have if its test began now.
  [[nodiscard]] std::vector<std::filesystem::path> untold(std::vector<std::filesystem::path> records,
                                                          const std::string& now);
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }

 private:
  [[nodiscard]] std::filesystem::path path_of(const FleetResult& result) const;
  void load();
  /// Writes the unsaved results, oldest first, until the disk refuses.
  void save();
  void forget(std::size_t index);
  /// Appends lines to `told`. Errors are ignored: a missing line means that a result is sent twice.
  void note_told(std::string_view lines);

  std::filesystem::path folder_;
  std::size_t most_;
  std::deque<FleetResult> results_;
  std::size_t unsaved_ = 0;  ///< The last `unsaved_` results are in memory only.
  std::uint64_t next_sequence_ = 1;
};

}  // namespace stickslip::fleet

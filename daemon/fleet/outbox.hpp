/// \file
/// Results on their way to the broker: in order, bounded, each a file of its own until the broker has it, so
/// that they outlive the broker's absence and the daemon's end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::fleet {

/// What the broker is told of one test.
struct FleetResult {
  std::string record;          ///< Name of the record, without folder and extension.
  std::string id;              ///< The record's entry_identifier_uuid.
  std::string payload;         ///< JSON.
  std::uint64_t sequence = 0;  ///< Set by the outbox: the order in which results were put in.
};

/// Thread-bound. The order is that of sequence numbers in the names of the files, no clock's. Beside the
/// results the folder holds the file `told`: the names of the records that were ever put in, a line each.
/// Records that it does not name were never told (backlog.hpp).
class Outbox {
 public:
  /// Reads what a former program has left. A folder that cannot be made or read is as one that is full: all
  /// stays in memory.
  Outbox(std::filesystem::path folder, std::size_t most);

  struct Added {
    bool is_new = false;   ///< False: it waits already.
    bool dropped = false;  ///< The oldest one had to go.
  };
  Added add(FleetResult result);
  /// The broker has it. \return false if it is not here any more.
  bool remove(const std::string& id);

  [[nodiscard]] const std::deque<FleetResult>& results() const noexcept { return results_; }
  /// Those of them that are in memory alone.
  [[nodiscard]] std::size_t unsaved_count() const noexcept { return unsaved_; }
  /// Those of the records that were never put in, in the order given. An outbox that is new begins with the
  /// tests to come: all records count as put in then. One of a former version has, instead of `told`, a file
  /// `newest` with the name of the latest record by the clock of then: all up to it count as put in, or none
  /// where that clock was ahead of today's.
  /// \param records  all that there are now. \param now  a record that began now would be named so.
  [[nodiscard]] std::vector<std::filesystem::path> untold(std::vector<std::filesystem::path> records,
                                                          const std::string& now);
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }

 private:
  [[nodiscard]] std::filesystem::path path_of(const FleetResult& result) const;
  void load();
  /// All that the disk has not got, oldest first, until it refuses.
  void save();
  void forget(std::size_t index);
  /// Durable or not: what is missing there is told twice.
  void note_told(std::string_view lines);

  std::filesystem::path folder_;
  std::size_t most_;
  std::deque<FleetResult> results_;
  std::size_t unsaved_ = 0;  ///< The last ones of them.
  std::uint64_t next_sequence_ = 1;
};

}  // namespace stickslip::fleet

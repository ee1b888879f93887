/// \file
/// Results on their way to the broker: in order, bounded, each a file of its own until the broker has it, so
/// that they outlive the broker's absence and the daemon's end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>

namespace stickslip::daemon {

/// What the broker is told of one test.
struct FleetResult {
  std::string record;   ///< Name of the record, without folder and extension; the order of the tests.
  std::string id;       ///< The record's entry_identifier_uuid.
  std::string payload;  ///< JSON.
};

/// Thread-bound. Beside the results the folder holds the file `newest`: the name of the latest record that
/// was ever put in. Records above it were never told (backlog.hpp).
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
  /// Nothing before the first result ever.
  [[nodiscard]] const std::string& newest() const noexcept { return newest_; }
  /// As if that record had been put in and removed.
  void set_newest(const std::string& record);
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }

 private:
  [[nodiscard]] std::filesystem::path path_of(const FleetResult& result) const;
  void load();
  /// All that the disk has not got, oldest first, until it refuses.
  void save();
  void forget(std::size_t index);

  std::filesystem::path folder_;
  std::size_t most_;
  std::deque<FleetResult> results_;
  std::size_t unsaved_ = 0;  ///< The last ones of them.
  std::string newest_;
};

}  // namespace stickslip::daemon

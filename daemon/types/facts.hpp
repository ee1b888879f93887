/// \file
/// What the daemon's parts have to say. They state facts; who implements this decides whether
/// and how they are logged.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "core/daq/board.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/note.hpp"
#include "core/estimate/sampling.hpp"
#include "core/pipeline/sink.hpp"
#include "daemon/types/fleet_state.hpp"
#include "daemon/types/scan_account.hpp"

namespace stickslip::daemon {

/// Thread-safe: called from all threads but acquisition.
class Facts {
 public:
  virtual ~Facts() = default;

  virtual void board_started(const daq::BoardInfo& /*board*/, std::string_view /*scheduling*/) {}
  /// Before the start: do the scans come often enough?
  virtual void sampling_checked(const estimate::SamplingVerdict& /*verdict*/) {}
  /// Before the start: the load cell is due to be calibrated again.
  virtual void calibration_expired(std::string_view /*expires*/) {}
  /// \param state  of the daemon: "board missing", "board busy" or "no permission".
  virtual void board_unavailable(std::string_view /*state*/, std::string_view /*why*/,
                                 double /*retry_in_s*/) {}
  /// \param test  the one that runs, if one does.
  virtual void gap_seen(const daq::Gap& /*gap*/, std::optional<std::int64_t> /*test*/) {}
  /// A stall of the computer, or a step of its date. \param test  as above.
  virtual void clock_noted(const daq::Note& /*note*/, std::optional<std::int64_t> /*test*/) {}
  /// The bench has been in a state that should pass by itself for so long. \param why  and what helps.
  virtual void bench_stays(std::string_view /*state*/, double /*duration_s*/, std::string_view /*why*/) {}
  virtual void test_began(const pipeline::TestStart& /*start*/) {}
  virtual void test_ended(const pipeline::TestEnd& /*end*/) {}
  virtual void file_published(std::int64_t /*test*/, const std::filesystem::path& /*file*/) {}
  virtual void recording_failed(std::int64_t /*test*/, std::string_view /*why*/) {}
  /// The journal of a test had gone from its place; it was written anew from what was open.
  virtual void journal_written_anew(std::int64_t /*test*/, const std::filesystem::path& /*before*/,
                                    const std::filesystem::path& /*now*/) {}
  /// The disk refuses, or the folder of the records is away; what comes waits in memory.
  virtual void storage_waits(std::string_view /*why*/) {}
  /// All that waited is written.
  virtual void storage_resumed() {}
  /// There is room for so few tests that none should be begun.
  virtual void storage_short(std::string_view /*why*/) {}
  virtual void storage_has_room() {}
  /// A test begins, and there is room for so long only.
  virtual void little_room(std::int64_t /*test*/, double /*room_s*/) {}
  /// At the start, once for each: what the file system of the records lacks, and what follows.
  virtual void record_folder_lacks(std::string_view /*what*/) {}
  /// A record was made, but not all that had been written could be read.
  virtual void record_damaged(const std::filesystem::path& /*file*/, std::string_view /*loss*/) {}
  virtual void orphan_finalised(const std::filesystem::path& /*file*/) {}
  virtual void orphan_kept(const std::filesystem::path& /*journal*/, std::string_view /*why*/) {}
  /// A folder of records cannot be looked into: journals in it became no records.
  virtual void folder_unread(const std::filesystem::path& /*folder*/, std::string_view /*why*/) {}
  /// Nothing had been recorded; the journal is removed.
  virtual void orphan_empty(const std::filesystem::path& /*journal*/) {}
  /// The broker is there, or away, or away for another reason.
  virtual void fleet_changed(const FleetState& /*state*/) {}
  virtual void control_listening(std::string_view /*socket*/) {}
  /// Parts of the daemon that do not move any more, so that the service manager will start it again; none
  /// if they move again. \param parts  separated by commas.
  virtual void hanging(std::string_view /*parts*/) {}
  /// A changed configuration is wrong and not used.
  virtual void reload_refused(std::string_view /*why*/) {}
  /// It is used as soon as nothing is being measured.
  virtual void reload_waits() {}
  virtual void stopping(std::string_view /*why*/) {}
  /// At the end, when nothing is under way.
  virtual void scans_accounted(const ScanAccount& /*scans*/) {}
};

}  // namespace stickslip::daemon

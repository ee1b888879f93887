#include "daemon/app/log.hpp"

#include <fmt/format.h>

#include <utility>

#include "io/findings_text.hpp"

#include "core/base/text.hpp"

namespace stickslip::app {
namespace {

class Log final : public daemon::EventReceiver {
 public:
  Log(io::LogLevel level, std::unique_ptr<LogOutput> output) : level_(level), output_(std::move(output)) {}

  void board_started(const daq::BoardInfo& board, std::string_view scheduling) override {
    tell({.event = "board-started",
          .message = fmt::format("board {} ({}, {}): {} Hz asked, {} Hz granted; acquisition thread {}",
                                 board.board_name, board.driver, board.device, board.scan_rate_requested_Hz,
                                 board.scan_rate_granted_Hz, scheduling),
          .state = "acquiring"});
    if (board.notes.empty()) return;
    tell({.event = "board-notes", .message = fmt::format("board {}: {}", board.device, board.notes)});
  }
  void load_cell_calibrated(const std::filesystem::path& file, double gain_N_per_V, std::string_view who,
                            const std::optional<daq::GainChange>& confirmed) override {
    tell({.level = confirmed ? io::LogLevel::kWarning : io::LogLevel::kInfo,
          .event = "load-cell-calibrated",
          .message = fmt::format("load cell calibrated by {}: {:.8g} N/V, kept in {}{}", who, gain_N_per_V,
                                 base::printable(file.string()),
                                 confirmed ? "; confirmed: " + daq::to_text(*confirmed) : std::string{})});
  }
  void calibration_expired(std::string_view expires) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "calibration-expired",
          .message = fmt::format("the calibration of the load cell expired on {}: calibrate, see stickslip "
                                 "calibrate --help",
                                 expires)});
  }
  void sampling_checked(const estimate::SamplingVerdict& verdict) override {
    using Kind = estimate::SamplingVerdict::Kind;
    if (verdict.kind != Kind::kFew && verdict.kind != Kind::kNotVerifiable) return;
    tell({.level = verdict.kind == Kind::kFew ? io::LogLevel::kWarning : io::LogLevel::kInfo,
          .event = "sampling",
          .message = fmt::format("sampling: {}", verdict.reason)});
  }
  void board_unavailable(std::string_view state, std::string_view why, double retry_in_s) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "board-unavailable",
          .message = fmt::format("{}: {}; next try in {} s", state, why, retry_in_s),
          .state = state});
  }
  void gap_seen(const daq::Gap& gap, std::optional<std::int64_t> test) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "gap",
          .message = fmt::format("gap: {}{} scans missing from scan {}: {}", gap.estimated ? "about " : "",
                                 gap.count, gap.first, daq::name(gap.cause)),
          .test = test,
          .cause = daq::name(gap.cause),
          .first_scan = gap.first,
          .scan_count = gap.count});
  }
  void clock_noted(const daq::Note& note, std::optional<std::int64_t> test) override {
    LogEntry entry{.level = io::LogLevel::kWarning,
                   .event = "clock-step",
                   .message = fmt::format("{} (scan {})", daq::to_text(note), note.scan),
                   .test = test,
                   .first_scan = note.scan};
    if (note.kind == daq::Note::Kind::kStall) entry.event = "stall";
    tell(std::move(entry));
  }
  void bench_stays(std::string_view state, double duration_s, std::string_view why) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "bench-stays",
          .message = fmt::format("the bench has been {} for {:.0f} s: {}", state, duration_s, why)});
  }
  void test_began(const pipeline::TestStart& start) override {
    tell({.event = "test-began",
          .message = fmt::format("test {} began: trigger at scan {}, record from scan {}", start.number,
                                 start.trigger, start.first),
          .test = start.number});
  }
  void test_ended(const pipeline::TestEnd& end) override {
    tell({.event = "test-ended",
          .message =
              fmt::format("test {} ended at scan {} ({}): {}, {} cycles", end.number, end.end,
                          pipeline::name(end.cause), model::name(end.results.regime), end.cycles.size()),
          .test = end.number,
          .cause = pipeline::name(end.cause)});
    for (const base::Finding& finding : end.results.findings) {
      tell({.level = finding.severity == base::Severity::kNote ? io::LogLevel::kInfo : io::LogLevel::kWarning,
            .event = "finding",
            .message = fmt::format("test {}: {}; {}", end.number, base::printable(finding.text),
                                   io::action_text(finding)),
            .test = end.number,
            .cause = finding.code});
    }
  }
  void file_published(std::int64_t test, const std::filesystem::path& file) override {
    tell({.event = "record-finished",
          .message = fmt::format("test {}: {}", test, file.string()),
          .test = test,
          .record = file.string()});
  }
  void recording_failed(std::int64_t test, std::string_view why) override {
    tell({.level = io::LogLevel::kError,
          .event = "record-failed",
          .message = fmt::format("test {} is not recorded whole: {}", test, why),
          .test = test});
  }
  void journal_written_anew(std::int64_t test, const std::filesystem::path& before,
                            const std::filesystem::path& now) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "journal-written-anew",
          .message =
              fmt::format("test {}: the journal was removed, renamed or replaced while it was open: {}; all "
                          "of it was written anew: {}",
                          test, before.string(), now.string()),
          .test = test,
          .record = now.string()});
  }
  void storage_waits(std::string_view why) override {
    tell({.level = io::LogLevel::kError, .event = "storage-waiting", .message = std::string{why}});
  }
  void storage_resumed() override {
    tell({.level = io::LogLevel::kWarning,
          .event = "storage-resumed",
          .message = "storage: the disk takes again: all that waited is written"});
  }
  void storage_short(std::string_view why) override {
    tell({.level = io::LogLevel::kError, .event = "storage-short", .message = std::string{why}});
  }
  void storage_has_room() override {
    tell({.level = io::LogLevel::kWarning,
          .event = "storage-has-room",
          .message = "storage: there is room for tests again"});
  }
  void little_room(std::int64_t test, double room_s) override {
    tell({.level = io::LogLevel::kError,
          .event = "little-room",
          .message = fmt::format("test {} begins with room on the disk for {:.0f} s", test, room_s),
          .test = test});
  }
  void config_outdated(std::string_view what) override {
    tell({.level = io::LogLevel::kWarning, .event = "config-outdated", .message = std::string{what}});
  }
  void record_folder_lacks(std::string_view what) override {
    tell({.level = io::LogLevel::kWarning, .event = "record-folder-lacks", .message = std::string{what}});
  }
  void record_damaged(const std::filesystem::path& file, std::string_view loss) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "record-damaged",
          .message = fmt::format("the record lacks what could not be read: {}: {}", file.string(), loss),
          .record = file.string()});
  }
  void orphan_finalised(const std::filesystem::path& file) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "record-recovered",
          .message = fmt::format("made from the journal of an interrupted test: {}", file.string()),
          .record = file.string()});
  }
  void orphan_kept(const std::filesystem::path& journal, std::string_view why) override {
    tell({.level = io::LogLevel::kError,
          .event = "journal-kept",
          .message = fmt::format("journal of an interrupted test kept: {}: {}", journal.string(), why),
          .record = journal.string()});
  }
  void folder_unread(const std::filesystem::path& folder, std::string_view why) override {
    tell(
        {.level = io::LogLevel::kError,
         .event = "folder-unread",
         .message = fmt::format("{}: cannot be looked into: {}; journals of interrupted tests in it are no "
                                "records yet: let the service's user have the folder, then stickslip recover",
                                folder.string(), why)});
  }
  void orphan_empty(const std::filesystem::path& journal) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "journal-removed",
          .message = fmt::format("removed, nothing was recorded in it before the program was stopped: {}",
                                 journal.string()),
          .record = journal.string()});
  }
  void fleet_changed(const daemon::FleetState& state) override {
    if (state.link == daemon::FleetState::Link::kConnected) {
      tell({.event = "broker-connected",
            .message = fmt::format("fleet: connected to {} as {}", state.broker, state.tester)});
    } else {
      tell({.level = io::LogLevel::kWarning,
            .event = "broker-away",
            .message = fmt::format("fleet: {}: {}; results wait in the outbox, {} of them now", state.broker,
                                   state.why, state.outbox_count)});
    }
  }
  void facts_refused(std::string_view topic, std::string_view why) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "facts-refused",
          .message = fmt::format("fleet: {}: {}", topic, why)});
  }
  void facts_expired(std::string_view topic, std::string_view keys, double valid_s) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "facts-expired",
          .message = fmt::format("fleet: {}: no message for {:.6g} s about {}: tests have the plan's facts; "
                                 "does the client that told them run?",
                                 topic, valid_s, keys)});
  }
  void trend_alarmed(const base::Finding& finding) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "finding",
          .message = fmt::format("tester: {}; {}", base::printable(finding.text), io::action_text(finding)),
          .cause = finding.code});
  }
  void trend_troubled(std::string_view why) override {
    tell({.level = io::LogLevel::kWarning,
          .event = "trend-trouble",
          .message = fmt::format("history of the tester: {}", why)});
  }
  void hanging(std::string_view parts) override {
    if (parts.empty()) {
      tell({.level = io::LogLevel::kWarning,
            .event = "watchdog-fed",
            .message = "watchdog: all parts move again"});
    } else {
      tell({.level = io::LogLevel::kError,
            .event = "watchdog-hungry",
            .message = fmt::format(
                "watchdog: not moving: {}; the service manager will start the daemon again", parts)});
    }
  }
  void reload_refused(std::string_view why) override {
    tell({.level = io::LogLevel::kError,
          .event = "reload-refused",
          .message = fmt::format("reload: the configuration stays as it was: {}", why)});
  }
  void reload_waits() override {
    tell({.event = "reload-waiting", .message = "reload: the configuration is good; used between two tests"});
  }
  void control_listening(std::string_view socket) override {
    tell({.event = "control-listening", .message = fmt::format("control: listening at {}", socket)});
  }
  void stopping(std::string_view why) override {
    tell({.event = "stopping", .message = fmt::format("stopping: {}", why), .state = "stopping"});
  }
  void scans_accounted(const daemon::ScanAccount& scans) override {
    const std::string account =
        fmt::format("scans: {} indices = {} in records + {} between tests + {} in gaps", scans.issued,
                    scans.recorded, scans.idle, scans.in_gaps);
    if (scans.unsaved > 0) {
      tell({.level = io::LogLevel::kError,
            .event = "scans-unsaved",
            .message =
                fmt::format("scans: {} of tests that the disk did not take are in no record", scans.unsaved),
            .scan_count = scans.unsaved});
    }
    if (scans.damaged > 0) {
      tell({.level = io::LogLevel::kError,
            .event = "scans-damaged",
            .message =
                fmt::format("scans: {} of journals that the disk damaged are in no record", scans.damaged),
            .scan_count = scans.damaged});
    }
    if (scans.under_way() == 0) {
      tell({.event = "scans-accounted",
            .message = fmt::format("{}{}", account,
                                   scans.unsaved + scans.damaged > 0
                                       ? fmt::format(" + {} in no record", scans.unsaved + scans.damaged)
                                       : std::string{})});
    } else {
      tell({.level = io::LogLevel::kError,
            .event = "scans-unaccounted",
            .message =
                fmt::format("{}: {} are unaccounted for, which is a defect of this program; please report it",
                            account, scans.under_way()),
            .scan_count = scans.under_way()});
    }
  }

 private:
  void tell(LogEntry entry) {
    if (entry.level < level_) return;
    entry.message = base::printable(entry.message);
    output_->write(entry);
  }

  io::LogLevel level_;
  std::unique_ptr<LogOutput> output_;
};

}  // namespace

std::unique_ptr<daemon::EventReceiver> make_log(io::LogLevel level, std::unique_ptr<LogOutput> output) {
  return std::make_unique<Log>(level, std::move(output));
}

}  // namespace stickslip::app

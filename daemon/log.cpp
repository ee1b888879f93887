#include "daemon/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <cstdlib>

namespace stickslip::daemon {
namespace {

/// %* in a pattern: the level as journald reads it at the start of a line.
class JournalLevel final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    const std::string_view prefix = prefix_of(message.level);
    out.append(prefix.data(), prefix.data() + prefix.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JournalLevel>();
  }

 private:
  static std::string_view prefix_of(spdlog::level::level_enum level) {
    switch (level) {
      case spdlog::level::critical:
      case spdlog::level::err:
        return SD_ERR;
      case spdlog::level::warn:
        return SD_WARNING;
      case spdlog::level::info:
        return SD_INFO;
      default:
        return SD_DEBUG;
    }
  }
};

spdlog::level::level_enum to_spdlog(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

class Log final : public Facts {
 public:
  explicit Log(LogLevel level) : logger_("stickslipd", std::make_shared<spdlog::sinks::stderr_sink_mt>()) {
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    if (std::getenv("JOURNAL_STREAM") != nullptr) {
      formatter->add_flag<JournalLevel>('*').set_pattern("%*%v");
    } else {
      formatter->set_pattern("%H:%M:%S.%e %l: %v");
    }
    logger_.set_formatter(std::move(formatter));
    logger_.set_level(to_spdlog(level));
    logger_.flush_on(spdlog::level::trace);
  }

  void board_started(const daq::BoardInfo& board, std::string_view scheduling) override {
    logger_.info("board {} ({}, {}): {} Hz asked, {} Hz granted; acquisition thread {}", board.board_name,
                 board.driver, board.device, board.scan_rate_requested_Hz, board.scan_rate_granted_Hz,
                 scheduling);
    if (!board.notes.empty()) logger_.info("board {}: {}", board.device, board.notes);
  }
  void calibration_expired(std::string_view expires) override {
    logger_.warn("the calibration of the load cell expired on {}: calibrate, see stickslip calibrate --help",
                 expires);
  }
  void sampling_checked(const friction::SamplingVerdict& verdict) override {
    using Kind = friction::SamplingVerdict::Kind;
    if (verdict.kind == Kind::kFew) logger_.warn("sampling: {}", verdict.reason);
    if (verdict.kind == Kind::kNotVerifiable) logger_.info("sampling: {}", verdict.reason);
  }
  void board_unavailable(std::string_view state, std::string_view why, double retry_in_s) override {
    logger_.warn("{}: {}; next try in {} s", state, why, retry_in_s);
  }
  void gap_seen(const daq::Gap& gap) override {
    logger_.warn("gap: {}{} scans missing from scan {}: {}", gap.estimated ? "about " : "", gap.count,
                 gap.first, daq::name(gap.cause));
  }
  void test_began(const pipeline::TestStart& start) override {
    logger_.info("test {} began: trigger at scan {}, record from scan {}", start.number, start.trigger,
                 start.first);
  }
  void test_ended(const pipeline::TestEnd& end) override {
    logger_.info("test {} ended at scan {} ({}): {}, {} cycles", end.number, end.end,
                 pipeline::name(end.cause), friction::name(end.results.regime), end.cycles.size());
  }
  void file_published(std::int64_t test, const std::filesystem::path& file) override {
    logger_.info("test {}: {}", test, file.string());
  }
  void recording_failed(std::int64_t test, std::string_view why) override {
    logger_.error("test {} is not recorded whole: {}", test, why);
  }
  void storage_waits(std::string_view why) override {
    logger_.error("the disk refuses, scans wait in memory: {}", why);
  }
  void storage_resumed() override { logger_.warn("the disk takes again: all that waited is written"); }
  void storage_short(std::string_view why) override { logger_.error("{}", why); }
  void storage_has_room() override { logger_.warn("storage: there is room for tests again"); }
  void little_room(std::int64_t test, double room_s) override {
    logger_.error("test {} begins with room on the disk for {:.0f} s", test, room_s);
  }
  void orphan_finalised(const std::filesystem::path& file) override {
    logger_.warn("made from the journal of an interrupted test: {}", file.string());
  }
  void orphan_kept(const std::filesystem::path& journal, std::string_view why) override {
    logger_.error("journal of an interrupted test kept: {}: {}", journal.string(), why);
  }
  void orphan_empty(const std::filesystem::path& journal) override {
    logger_.warn("removed, nothing was recorded in it before the program was stopped: {}", journal.string());
  }
  void fleet_changed(const FleetState& state) override {
    if (state.link == FleetState::Link::kConnected) {
      logger_.info("fleet: connected to {} as {}", state.broker, state.tester);
    } else {
      logger_.warn("fleet: {}: {}; results wait in the outbox, {} of them now", state.broker, state.why,
                   state.outbox_count);
    }
  }
  void hanging(std::string_view parts) override {
    if (parts.empty()) {
      logger_.warn("watchdog: all parts move again");
    } else {
      logger_.error("watchdog: not moving: {}; the service manager will start the daemon again", parts);
    }
  }
  void reload_refused(std::string_view why) override {
    logger_.error("reload: the configuration stays as it was: {}", why);
  }
  void reload_waits() override { logger_.info("reload: the configuration is good; used between two tests"); }
  void control_listening(std::string_view socket) override {
    logger_.info("control: listening at {}", socket);
  }
  void stopping(std::string_view why) override { logger_.info("stopping: {}", why); }
  void scans_accounted(const ScanAccount& scans) override {
    const std::string account =
        fmt::format("scans: {} indices = {} in records + {} between tests + {} in gaps", scans.issued,
                    scans.recorded, scans.idle, scans.in_gaps);
    if (scans.unsaved > 0)
      logger_.error("scans: {} of tests that the disk did not take are in no record", scans.unsaved);
    if (scans.under_way() == 0) {
      logger_.info("{}{}", account,
                   scans.unsaved > 0 ? fmt::format(" + {} in no record", scans.unsaved) : "");
    } else {
      logger_.error("{}: {} are unaccounted for, which is a defect of this program; please report it",
                    account, scans.under_way());
    }
  }

 private:
  spdlog::logger logger_;
};

}  // namespace

std::unique_ptr<Facts> make_log(LogLevel level) { return std::make_unique<Log>(level); }

}  // namespace stickslip::daemon

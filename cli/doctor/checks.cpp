#include "cli/doctor/checks.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "io/calibration_file.hpp"
#include <nlohmann/json.hpp>

#include "core/base/shell_word.hpp"
#include "core/base/version.hpp"
#include "core/record/iso_time.hpp"
#include "daemon/runtime/session_setup.hpp"
#include "daemon/storage/disk_writer.hpp"
#include "daemon/storage/finaliser_process.hpp"
#include "daemon/types/tester_history.hpp"

namespace stickslip::doctor {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSecondsPerDay = 86'400.0;
/// A calibration that expires within this time is a warning, so that there is time for a new one.
constexpr double kCalibrationDue_s = 30 * kSecondsPerDay;
/// Room for less than this time of scanning, a working day, is a warning.
constexpr double kLittleRoom_s = 8 * 3600.0;
/// Largest growth of journal and record for one scan: counts of 32 bits twice, and time, scan, force, flags.
/// As bytes_per_scan() in daemon/storage/storage.cpp.
constexpr double kBytesPerScan = 2 * 4.0 + 8 + 8 + 4 + 1;
/// Lockable memory that a daemon needs, bytes. mlockall() counts all mapped memory: 287 MB of a daemon at 350
/// Hz, of which 28 MB are touched.
constexpr std::uint64_t kLockedSize = 512ULL << 20;

class Examination {
 public:
  Examination(std::filesystem::path file, const DoctorWorld& world) : file_(std::move(file)), world_(world) {}

  std::vector<Finding> all() && {
    look_at_config();
    look_at_daemon();
    look_at_bench();
    look_at_board();
    look_at_calibration();
    look_at_records();
    look_at_file_system();
    look_at_disk();
    look_at_realtime();
    look_at_clock();
    look_at_fleet();
    look_at_trend();
    return std::move(findings_);
  }

 private:
  void good(std::string check, std::string what) {
    findings_.push_back({std::move(check), Finding::Verdict::kGood, std::move(what), {}});
  }
  void unknown(std::string check) {
    findings_.push_back(
        {std::move(check), Finding::Verdict::kUnknown, "not looked at", "mend what is said above first"});
  }
  void warn(std::string check, std::string what, std::string to_do) {
    findings_.push_back({std::move(check), Finding::Verdict::kWarning, std::move(what), std::move(to_do)});
  }
  void bad(std::string check, std::string what, std::string to_do) {
    findings_.push_back({std::move(check), Finding::Verdict::kBad, std::move(what), std::move(to_do)});
  }
  /// Uses the status of a running daemon.
  [[nodiscard]] bool acquiring() const {
    const std::string state = status_.value("state", "");
    return state == "acquiring" || state.starts_with("storage");
  }

  void look_at_config() {
    base::Result<io::DaemonConfig> config = io::load_config(file_);
    if (!config) {
      std::error_code error;
      bad("config", config.error().message,
          std::filesystem::exists(file_, error)
              ? fmt::format("correct the line; then stickslipd --check-config {}", file_.string())
              : "name it: stickslip doctor --config FILE; without a board, stickslip demo needs none; with "
                "one, stickslip boards "
                "says what to write into it");
      return;
    }
    if (auto board = drivers::check_board(config->board); !board) {
      bad("config", board.error().message, "correct the file that it names");
      return;
    }
    config_ = *std::move(config);
    good("config", file_.string());
  }

  void look_at_daemon() {
    if (!config_) return unknown("daemon");
    if (!config_->control_socket) {
      return warn("daemon", "the configuration names no control socket: a running daemon cannot be asked",
                  "say [control] socket = \"/run/stickslip/control.sock\"");
    }
    const std::filesystem::path& socket = *config_->control_socket;
    const base::Result<daemon::HttpReply> reply = world_.ask_status(socket);
    if (!reply) {
      std::error_code error;
      const bool there = std::filesystem::exists(socket, error);
      if (there && ::access(socket.c_str(), W_OK) != 0) {
        return bad("daemon", fmt::format("{}: this user may not ask it", socket.string()),
                   "usermod -aG stickslip USER, and log in again");
      }
      return bad("daemon", reply.error().message,
                 "systemctl enable --now stickslipd; journalctl -u stickslipd says why it ended");
    }
    status_ = Json::parse(reply->body, nullptr, false);
    if (reply->status != 200 || !status_.is_object()) {
      status_ = Json::object();
      return bad("daemon", fmt::format("{}: no status but {}", socket.string(), reply->status),
                 "is another program listening there?");
    }
    const std::string state = status_.value("state", "");
    const std::string detail = status_.value("detail", state);
    if (!acquiring()) {
      bad("daemon", detail, "see board, below; the daemon goes on by itself once the cause is gone");
    } else if (const std::string version = status_.value("version", ""); version != base::kVersion) {
      warn("daemon", fmt::format("version {} runs, {} is installed", version, base::kVersion),
           "systemctl restart stickslipd");
    } else {
      good("daemon", detail);
    }
    const auto lost = status_.value("dropped_scan_count", 0) + status_.value("lost_scan_count", 0);
    if (lost > 0) {
      warn("scans", fmt::format("{} scans were lost since the daemon began", lost),
           "look at gaps in the records; see realtime, below");
    }
  }

  /// Gives no finding if the bench is in order.
  void look_at_bench() {
    const Json trouble = status_.value("bench_trouble", Json());
    if (!trouble.is_string()) return;
    // "What it is: what helps".
    const auto text = trouble.get<std::string>();
    const std::size_t colon = text.find(": ");
    warn("bench", fmt::format("{}: {}", status_.value("bench", ""), text.substr(0, colon)),
         colon == text.npos ? "docs/states.md" : text.substr(colon + 2));
  }

  void look_at_board() {
    if (!config_) return unknown("board");
    if (acquiring()) return look_at_running_board();
    base::Result<drivers::OpenedBoard> board = world_.open_board(config_->board, *world_.clock);
    if (!board) {
      switch (board.error().kind) {
        case base::ErrorKind::kBusy:
          return bad("board", board.error().message, "end the other program");
        case base::ErrorKind::kNoPermission:
          return bad(
              "board", board.error().message,
              "run this as the service's user; for that user: usermod -aG iocard USER, and log in again");
        default:
          return bad("board", board.error().message,
                     "stickslip boards says what there is and what to configure");
      }
    }
    const daq::BoardInfo& info = board->board->info();
    good("board",
         fmt::format("{} ({}), {} Hz granted", info.board_name, info.driver, info.scan_rate_granted_Hz));
    scan_rate_Hz_ = info.scan_rate_granted_Hz;
    const base::Result<runtime::SessionSettings> settings = runtime::session_settings(*config_, *board, {});
    if (!settings) return bad("rate", settings.error().message, "correct the configuration");
    const auto sampling = runtime::check_sampling(*config_, *settings);
    if (!sampling) return bad("rate", sampling.error().message, "raise [board] scan_rate");
    if (sampling->kind == estimate::SamplingVerdict::Kind::kFew) {
      return warn("rate", sampling->reason, "raise [board] scan_rate");
    }
    if (sampling->kind == estimate::SamplingVerdict::Kind::kNotVerifiable) {
      return warn("rate", sampling->reason, "stickslip characterise, or say [tester] stiffness");
    }
    good("rate", fmt::format("{} Hz", info.scan_rate_granted_Hz));
  }

  void look_at_running_board() {
    const Json board = status_.value("board", Json::object());
    scan_rate_Hz_ = board.value("scan_rate_granted", 350.0);
    good("board",
         fmt::format("{} ({}), in use by the daemon", board.value("name", ""), board.value("driver", "")));
    const Json measured = status_.value("scan_rate_measured", Json());
    if (!measured.is_object()) return good("rate", fmt::format("{} Hz", scan_rate_Hz_));
    const double off = measured.value("value", scan_rate_Hz_) / scan_rate_Hz_ - 1.0;
    const std::string text =
        fmt::format("{} Hz, by this computer's clock {:+.0f} ppm", scan_rate_Hz_, 1e6 * off);
    if (std::abs(off) > config_->board.comedi.scan_rate_tolerance) {
      return warn("rate", text,
                  "one of the two clocks is wrong: see clock, below, then have the board checked");
    }
    good("rate", text);
  }

  void look_at_calibration() {
    if (!config_) return unknown("calibration");
    if (!config_->bench.calibration) {
      return warn("calibration", "none: results have no uncertainty of the load cell",
                  "stickslip calibrate, then [tester] calibration");
    }
    const record::CalibrationFacts& facts = *config_->bench.calibration;
    const std::int64_t now_ns = world_.clock->realtime_ns();
    if (io::expired(facts, record::iso_time(now_ns))) {
      return warn("calibration", fmt::format("expired on {}", facts.expires), "stickslip calibrate");
    }
    if (io::expired(facts, record::iso_time(now_ns + static_cast<std::int64_t>(1e9 * kCalibrationDue_s)))) {
      return warn("calibration", fmt::format("expires on {}", facts.expires), "plan to calibrate");
    }
    good("calibration",
         fmt::format("of {}{}", facts.date, facts.expires.empty() ? "" : ", expires on " + facts.expires));
  }

  void look_at_records() {
    if (!config_) return unknown("records");
    // The nearest one that is there: the daemon makes the rest.
    std::error_code error;
    folder_ = std::filesystem::absolute(config_->record_folder, error);
    const std::filesystem::path wanted = folder_;
    while (!std::filesystem::exists(folder_, error) && folder_.has_relative_path())
      folder_ = folder_.parent_path();
    if (!std::filesystem::is_directory(folder_, error)) {
      return bad("records", fmt::format("{} is no folder", folder_.string()), "say another [record] folder");
    }
    if (::access(folder_.c_str(), W_OK | X_OK) != 0) {
      const bool read_only = errno == EROFS;
      const bool others = !status_.empty();  // The daemon has another user's rights.
      const std::string what = fmt::format(
          "{}: {}", folder_.string(),
          read_only ? "its file system is mounted for reading only" : "this user may not write there");
      const std::string to_do =
          read_only
              ? "look into the kernel's log for why, then mount -o remount,rw; or say another [record] folder"
              : "let the service's user have it: chown stickslip: FOLDER";
      return others && !read_only ? good("records", fmt::format("{} (the daemon's)", wanted.string()))
                                  : bad("records", what, to_do);
    }
    const io::FilesFound orphans = status_.empty() ? storage::journals_in(wanted) : io::FilesFound{};
    if (!orphans.unread.empty()) {
      const auto& [folder, why] = orphans.unread.front();
      return bad("records", fmt::format("{}: cannot be looked into: {}", folder.string(), why),
                 fmt::format("let the service's user have it: chown -R stickslip: {}", folder.string()));
    }
    if (!orphans.files.empty()) {
      return warn("records",
                  fmt::format("{}: {} journals of tests that a stop interrupted", wanted.string(),
                              orphans.files.size()),
                  fmt::format("start the daemon, or stickslip recover {}", wanted.string()));
    }
    good("records", wanted.string());
  }

  void look_at_file_system() {
    if (!config_ || folder_.empty()) return unknown("filesystem");
    const std::string better = "ext4, XFS and Btrfs on a disk of this computer lack nothing";
    // The daemon has tried it with its own rights.
    if (const Json storage = status_.value("storage", Json::object()); storage.contains("lacks")) {
      for (const Json& lack : storage["lacks"])
        warn("filesystem", lack.is_string() ? lack.get<std::string>() : lack.dump(), better);
      if (storage["lacks"].empty()) good("filesystem", "as the daemon tried at its start, lacks nothing");
      return;
    }
    if (::access(folder_.c_str(), W_OK | X_OK) != 0) return unknown("filesystem");
    const auto lacks = world_.probe(folder_);
    if (!lacks) {
      return bad("filesystem", fmt::format("{}: {}", folder_.string(), lacks.error().message),
                 "say another [record] folder, or mend its disk: no record can be made there");
    }
    for (const record::FolderLack& lack : *lacks) {
      warn("filesystem", fmt::format("{}: the file system {}: {}", folder_.string(), lack.what, lack.follows),
           better);
    }
    if (lacks->empty()) good("filesystem", fmt::format("{} lacks nothing", folder_.string()));
  }

  void look_at_disk() {
    if (!config_ || folder_.empty()) return unknown("disk");
    const std::int64_t room = world_.room(folder_);
    if (room < 0) return bad("disk", fmt::format("{}: cannot be asked", folder_.string()), "is it mounted?");
    const double room_s =
        static_cast<double>(room) / (scan_rate_Hz_ * kBytesPerScan + storage::kOtherBytesPerSecond);
    const std::string text = fmt::format("room for {:.1f} h of scanning", room_s / 3600.0);
    const std::string to_do = fmt::format("make room at {}", folder_.string());
    if (room_s < storage::kLeastRoom_s) return bad("disk", text, to_do);
    if (room_s < kLittleRoom_s) return warn("disk", text, to_do);
    good("disk", text);
  }

  void look_at_realtime() {
    if (!config_) return unknown("realtime");
    const std::string to_do =
        "the unit as shipped gives both (LimitRTPRIO, LimitMEMLOCK); by hand: /etc/security/limits.d";
    if (acquiring()) {
      const std::string granted = status_.value("scheduling", "");
      const bool less =
          granted.find("refused") != std::string::npos || granted.find("not locked (") != std::string::npos;
      const bool unasked = granted.find("not asked for") != std::string::npos;
      return less && !unasked ? warn("realtime", granted, to_do) : good("realtime", granted);
    }
    if (config_->clock_speed != 1.0) return good("realtime", "not needed: no hardware's time");
    const int allowed = world_.realtime_priority();
    const auto lockable = world_.lockable_size();
    const int wanted = config_->realtime.priority;
    std::string what;
    if (allowed < wanted) what = fmt::format("SCHED_FIFO {} is wanted, {} is allowed", wanted, allowed);
    if (config_->realtime.lock_memory && lockable && *lockable < kLockedSize) {
      what += fmt::format("{}{} kB of memory may be locked", what.empty() ? "" : "; ", *lockable / 1024);
    }
    if (!what.empty()) return warn("realtime", what + " (for this user)", to_do);
    good("realtime", fmt::format("SCHED_FIFO {} allowed, kernel {}", wanted, runtime::kernel_preemption()));
  }

  void look_at_clock() {
    if (!world_.clock_is_synchronised()) {
      return warn("clock", "this computer's clock is not synchronised: dates of records may be wrong",
                  "apt install chrony, or systemctl enable --now systemd-timesyncd");
    }
    good("clock", "synchronised");
  }

  void look_at_fleet() {
    if (!config_ || !config_->fleet) return;
    if (auto files = io::check_files(*config_->fleet); !files) {
      return bad("fleet", files.error().message, "correct the file or its rights; docs/fleet.md");
    }
    const Json fleet = status_.value("fleet", Json());
    if (!fleet.is_object()) return good("fleet", fmt::format("{}, not asked", config_->fleet->broker_url));
    const std::string state = fleet.value("state", "");
    const auto dropped = fleet.value("dropped_result_count", 0);
    if (state != "connected" || dropped > 0) {
      const Json why = fleet.value("why", Json());
      return warn("fleet",
                  fmt::format("{}: {}{}; {} results wait, {} were dropped", config_->fleet->broker_url, state,
                              why.is_string() ? ": " + why.get<std::string>() : "",
                              fleet.value("outbox_count", 0), dropped),
                  "is the broker there, and is this tester's name, password and topic right? docs/fleet.md");
    }
    good("fleet", fmt::format("{}, connected as {}", config_->fleet->broker_url, config_->fleet->tester));
  }

  void look_at_trend() {
    constexpr const char* kDamagedHistory =
        "let this user read it, or, if it is damaged, move it away: the charts then begin anew";
    if (!config_) return unknown("trend");
    const std::string folder = base::shell_word(config_->record_folder.string());
    daemon::TesterHistory history{config_->record_folder};
    auto read = history.read_on();
    const auto charts = read ? daemon::charts_now(history) : tl::unexpected(read.error());
    if (!charts) {
      return warn("trend", charts.error().message,
                  read ? "let this user read it; it says which tests are void" : kDamagedHistory);
    }
    if (!read->empty()) warn("trend", read->front(), kDamagedHistory);
    const std::vector<base::Finding> alarms = charts->findings();
    for (const base::Finding& alarm : alarms) {
      warn("trend", alarm.text,
           fmt::format("{}; stickslip trend {} --restart {} --reason TEXT", alarm.action, folder,
                       alarm.code.substr(alarm.code.find('-') + 1)));
    }
    if (alarms.empty() && read->empty())
      good("trend", history.events().empty() ? "no test is charted yet" : "no alarm of a control chart");
  }

  std::filesystem::path file_;
  const DoctorWorld& world_;
  std::vector<Finding> findings_;
  std::optional<io::DaemonConfig> config_;
  Json status_ = Json::object();  ///< Status of the daemon; empty if none answers.
  std::filesystem::path folder_;  ///< The record folder, or its nearest existing parent.
  double scan_rate_Hz_ = 350.0;   ///< That of [Penner 1995], until the board is known.
};

}  // namespace

std::vector<Finding> examine(const std::filesystem::path& configuration, const DoctorWorld& world) {
  return Examination{configuration, world}.all();
}

}  // namespace stickslip::doctor

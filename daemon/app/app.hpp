/// \file
/// stickslipd as a whole: owns all its parts and drives them through the daemon's states.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/config.hpp"
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/base/clock.hpp"
#include "daemon/app/test_watcher.hpp"
#include "daemon/batch/leader.hpp"
#include "daemon/charts/keeper.hpp"
#include "daemon/control/api.hpp"
#include "daemon/control/server.hpp"
#include "daemon/fleet/fleet.hpp"
#include "daemon/live/stream.hpp"
#include "daemon/page/report_jobs.hpp"
#include "daemon/runtime/command_service.hpp"
#include "daemon/runtime/notify.hpp"
#include "daemon/runtime/session.hpp"
#include "daemon/runtime/session_setup.hpp"
#include "daemon/runtime/watchdog.hpp"
#include "daemon/storage/storage.hpp"
#include "daemon/types/event_receiver.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::app {

/// The daemon's dependencies; tests replace them.
struct AppWorld {
  runtime::RecordFolder record_folder;  ///< The configured record folder, prepared.
  std::function<base::Result<drivers::OpenedBoard>(const drivers::BoardConfig&, base::Clock&,
                                                   const daq::Predecessor&)>
      open_board;
  storage::Finalise finalise;
  daemon::EventReceiver* events = nullptr;  ///< Outlives the App.
  /// Called on the main thread with each new line of STATUS=; may be empty.
  std::function<void(const std::string&)> status_changed;
  /// True if a signal to end came before run(); may be empty.
  std::function<bool()> stop_asked;
  /// Called at SIGHUP: checks the present configuration file. Empty: SIGHUP ends the program.
  std::function<base::Result<void>()> check_config;
  std::unique_ptr<base::Clock> clock;  ///< Null: the machine's clock, at the configured speed.
  /// Pause before a missing board is tried again; it doubles up to 30 s.
  std::chrono::milliseconds first_retry{1000};
};

/// Thread-bound: the main thread. States:
///
///     starting → acquiring ⇄ board missing, board busy, no permission → stopping → (run() returns)
class App {
 public:
  App(io::DaemonConfig config, AppWorld world);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Blocks until SIGTERM, SIGINT or the end of the input; then drains the ring, ends the running test and
  /// finishes its record. After SIGHUP it ends when no test and no calibration is under way. Errors mean that
  /// the daemon never became ready: kUsage (configuration), kFailure (record folder or control socket).
  [[nodiscard]] base::Result<void> run();

  /// Acts as SIGTERM. Any thread.
  void request_stop();

  /// True if run() ended because of SIGHUP: another App with the present configuration should take over.
  [[nodiscard]] bool is_to_be_reloaded() const noexcept { return reloads_; }

  /// The latest tests.
  [[nodiscard]] const daemon::TestLog& tests() const noexcept { return tests_; }
  [[nodiscard]] daemon::Status status() const;
  [[nodiscard]] daemon::ScanAccount scan_account() const;

 private:
  /// In the last three before kStopping the daemon waits for the board: it is missing, another program uses
  /// it, or its device file forbids access.
  enum class State { kStarting, kAcquiring, kBoardMissing, kBoardBusy, kNoPermission, kStopping };
  /// Name in status and log.
  [[nodiscard]] static std::string_view name(State state) noexcept;
  /// The waiting state after an error of this kind.
  [[nodiscard]] static State waiting_state(base::ErrorKind kind) noexcept;

  void wait_for_signal();
  void reload();
  void reload_when_idle();
  /// Ends the session and begins the reload. Called on the processing thread, when the bench is at rest.
  void reload_at_rest(runtime::Session& session);
  void reload_now();
  void look_again_for_reload();
  /// The threads that the watchdog watches.
  [[nodiscard]] std::vector<runtime::WatchedPart> watched_parts();
  /// Reports readiness, whether or not there is a board.
  void tell_ready();
  [[nodiscard]] base::Result<void> open_session();
  void wait_for_board(const base::Error& why);
  void retry_board();
  void session_ended(runtime::Acquisition::End end);
  void stop(const std::string& why);
  void leave_when_idle();
  void tell_status();
  /// status() for those who ask again and again: the next one has what changed in the history of the tester.
  [[nodiscard]] daemon::Status asked_status();
  [[nodiscard]] std::string status_line() const;
  [[nodiscard]] std::string state_line() const;  ///< As status_line(), without the storage.
  /// Real-time settings in force; valid while there is a session.
  [[nodiscard]] std::string realtime_facts() const;
  /// Opens the configured socket and port.
  [[nodiscard]] base::Result<void> open_control();
  /// Connects to the broker, if one is configured.
  [[nodiscard]] base::Result<void> open_fleet();
  /// The sinks of a session.
  [[nodiscard]] std::vector<pipeline::Sink*> sinks();

  io::DaemonConfig config_;
  AppWorld world_;
  boost::asio::io_context io_{1};
  boost::asio::signal_set signals_;
  boost::asio::steady_timer retry_timer_;
  boost::asio::steady_timer reload_timer_;
  storage::Finalise finalise_;
  std::unique_ptr<base::Clock> clock_;
  runtime::Notify notify_;
  daemon::TestLog tests_;
  storage::Storage storage_;
  TestWatcher watcher_;
  live::LiveStream live_;
  batch::BatchLeader batches_;
  charts::Keeper charts_;
  page::ReportJobs reports_;
  std::unique_ptr<base::Clock> wall_;  ///< Wall time, for the lease, dates and messages.
  control::Lease lease_;
  runtime::CalibrationService calibrations_;
  runtime::CommandService commands_;
  std::unique_ptr<fleet::Fleet> fleet_;  ///< Null: no broker is configured.
  std::vector<std::unique_ptr<control::ControlServer>> control_;
  std::optional<daemon::Status::Page> page_;  ///< The live page, while it is served.
  std::shared_ptr<const model::TruthSource> truth_;
  std::unique_ptr<runtime::Session> session_;

  runtime::Watchdog watchdog_;
  bool reload_asked_ = false;
  /// The processing thread starts the reload when the bench is at rest.
  std::atomic<bool> reload_at_rest_{false};
  bool reloads_ = false;
  std::string process_facts_;  ///< Result of prepare_process().
  State state_ = State::kStarting;
  std::string waiting_why_;  ///< Why the board is not available.
  std::chrono::milliseconds retry_after_;
  runtime::SessionEnd continues_;
  runtime::SessionCounts counts_;
  std::uint64_t board_loss_count_ = 0;
  std::int64_t issued_before_ = 0;  ///< Scan indices issued in earlier sessions.
  runtime::SessionClocks clocks_;   ///< Timing of the latest session.
  std::optional<std::int64_t> current_test_;
  std::optional<double> sled_mass_kg_;  ///< Of the latest session.
};

}  // namespace stickslip::app

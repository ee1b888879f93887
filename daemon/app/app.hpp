/// \file
/// stickslipd as a whole: who lives how long, and what follows from what.
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
#include "daemon/control/api.hpp"
#include "daemon/control/server.hpp"
#include "daemon/fleet/fleet.hpp"
#include "daemon/live/stream.hpp"
#include "daemon/page/report_desk.hpp"
#include "daemon/runtime/bench_desk.hpp"
#include "daemon/runtime/notify.hpp"
#include "daemon/runtime/session.hpp"
#include "daemon/runtime/session_setup.hpp"
#include "daemon/runtime/watchdog.hpp"
#include "daemon/storage/storage.hpp"
#include "daemon/types/facts.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::app {

/// What the daemon takes from the world; tests give their own.
struct AppWorld {
  runtime::RecordFolder record_folder;  ///< That of the configuration, prepared.
  std::function<base::Result<drivers::OpenedBoard>(const drivers::BoardConfig&, base::Clock&,
                                                   const std::optional<daq::Continuation>&)>
      open_board;
  storage::Finalise finalise;
  daemon::Facts* facts = nullptr;  ///< Outlives the App.
  /// Told each new line of STATUS=, on the main thread; may be empty.
  std::function<void(const std::string&)> status_changed;
  /// Whether a signal to end came before run(); may be empty.
  std::function<bool()> stop_asked;
  /// SIGHUP: whether the configuration as it is now is good. Empty: SIGHUP ends the program.
  std::function<base::Result<void>()> check_config;
  std::unique_ptr<base::Clock> clock;           ///< Null: the machine's, as fast as configured.
  std::chrono::milliseconds first_retry{1000};  ///< Of a missing board; then twice as long each time.
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

  /// Runs until SIGTERM, SIGINT or the end of the input: drains, ends the running test, finishes its file.
  /// Or, after a SIGHUP, until no test and no calibration is under way. Errors mean that it never got ready:
  /// kUsage (configuration), kFailure (record folder or control socket).
  [[nodiscard]] base::Result<void> run();

  /// Any thread, any time after construction: as SIGTERM.
  void request_stop();

  /// run() ended so that another App, with the configuration as it is now, takes its place.
  [[nodiscard]] bool is_to_be_reloaded() const noexcept { return reloads_; }

  /// Tests so far.
  [[nodiscard]] const daemon::TestLog& tests() const noexcept { return tests_; }
  [[nodiscard]] daemon::Status status() const;
  [[nodiscard]] daemon::ScanAccount scan_account() const;

 private:
  /// The three in the middle wait for the board: it is not there, another program has it, its device
  /// file is not for this user.
  enum class State { kStarting, kAcquiring, kBoardMissing, kBoardBusy, kNoPermission, kStopping };
  /// The word in status and log.
  [[nodiscard]] static std::string_view name(State state) noexcept;
  /// The one to wait in after an error of this kind.
  [[nodiscard]] static State waiting_state(base::ErrorKind kind) noexcept;

  void wait_for_signal();
  void reload();
  void reload_when_idle();
  /// On the processing thread: the bench rests.
  void reload_at_rest(runtime::Session& session);
  void reload_now();
  void look_again_for_reload();
  /// What the service manager watches.
  [[nodiscard]] std::vector<runtime::WatchedPart> watched_parts();
  /// The daemon is ready to be used, whether or not there is a board.
  void tell_ready();
  [[nodiscard]] base::Result<void> open_session();
  void wait_for_board(const base::Error& why);
  void retry_board();
  void session_ended(runtime::Acquisition::End end);
  void stop(const std::string& why);
  void leave_when_idle();
  void tell_status();
  [[nodiscard]] std::string status_line() const;
  [[nodiscard]] std::string state_line() const;  ///< Without the disk.
  /// What the kernel granted; only while there is a session.
  [[nodiscard]] std::string realtime_facts() const;
  /// Socket and port, as configured.
  [[nodiscard]] base::Result<void> open_control();
  /// The broker, if one is configured.
  [[nodiscard]] base::Result<void> open_fleet();
  /// Who is told of the scans.
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
  page::ReportDesk reports_;
  std::unique_ptr<base::Clock> wall_;  ///< Of leases, dates and messages: people's time.
  runtime::CalibrationDesk calibrations_;
  runtime::BenchDesk desk_;
  std::unique_ptr<fleet::Fleet> fleet_;  ///< Null without a broker.
  std::vector<std::unique_ptr<control::ControlServer>> control_;
  std::optional<daemon::Status::Page> page_;  ///< While it is served.
  std::shared_ptr<const model::TruthSource> truth_;
  std::unique_ptr<runtime::Session> session_;

  runtime::Watchdog watchdog_;
  bool reload_asked_ = false;
  std::atomic<bool> reload_at_rest_{false};  ///< The processing thread begins it when no test is under way.
  bool reloads_ = false;
  std::string process_facts_;  ///< Of prepare_process().
  State state_ = State::kStarting;
  std::string waiting_why_;  ///< While the board is waited for.
  std::chrono::milliseconds retry_after_;
  runtime::SessionEnd continues_;
  runtime::SessionCounts counts_;
  std::uint64_t board_loss_count_ = 0;
  std::int64_t issued_before_ = 0;  ///< Indices, by the sessions that are over.
  runtime::SessionClocks clocks_;   ///< Of the latest session.
  std::optional<std::int64_t> current_test_;
};

}  // namespace stickslip::app

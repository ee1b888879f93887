#include "daemon/app.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>

#include "core/friction/sampling.hpp"
#include "core/pipeline/gain_uncertainty.hpp"
#include "core/record/iso_time.hpp"
#include "daemon/calibration_file.hpp"
#include "daemon/method_text.hpp"
#include "daemon/recovery.hpp"
#include "daemon/tester_file.hpp"
#include "daemon/version.hpp"

namespace stickslip::daemon {
namespace {

/// Tries to open a missing board: after 1, 2, 4, 8, 16, 30, 30 … s.
constexpr std::chrono::seconds kLongestRetry{30};

/// Room for longer is not told in one line: 30 days without a pause.
constexpr double kTellRoom_h = 720.0;

/// As far as permissions go.
Finalise read_only(Finalise finalise) {
  return [finalise = std::move(finalise)](const std::filesystem::path& journal) {
    auto file = finalise(journal);
    constexpr mode_t kEverybodyReads = 0444;
    // The record is whole; that it can be written to is no reason to refuse it.
    if (file) static_cast<void>(::chmod(file->c_str(), kEverybodyReads));
    return file;
  };
}

}  // namespace

/// Sees the tests on the processing thread; adds them to the log, tells facts and main thread.
class App::Watcher final : public pipeline::Sink {
 public:
  explicit Watcher(App& app) : app_(app) {}

  /// Only between sessions.
  void use(const friction::TruthSource* truth) { truth_ = truth; }

  void test_began(const pipeline::TestStart& start) override {
    first_ = start.first;
    app_.world_.facts->test_began(start);
    post_current(start.number);
  }

  void gap(const daq::Gap& gap) override { app_.world_.facts->gap_seen(gap); }
  void gap_between_tests(const daq::Gap& gap) override { app_.world_.facts->gap_seen(gap); }

  void test_ended(const pipeline::TestEnd& end) override {
    TestSummary summary;
    summary.number = end.number;
    summary.first = first_;
    summary.end = end.end;
    summary.cause = end.cause;
    summary.results = end.results;
    if (truth_ != nullptr) summary.truth = truth_->truth(first_, end.end);
    app_.tests_.add(std::move(summary));
    app_.world_.facts->test_ended(end);
    post_current(std::nullopt);
  }

 private:
  void post_current(std::optional<std::int64_t> number) {
    boost::asio::post(app_.io_, [&app = app_, number] {
      app.current_test_ = number;
      app.tell_status();
    });
  }

  App& app_;
  const friction::TruthSource* truth_ = nullptr;
  daq::ScanIndex first_ = 0;
};

App::App(DaemonConfig config, AppWorld world)
    : config_(std::move(config)),
      world_(std::move(world)),
      signals_(io_),
      retry_timer_(io_),
      finalise_(config_.read_only_records ? read_only(world_.finalise) : world_.finalise),
      clock_(world_.clock ? std::move(world_.clock) : base::make_system_clock(config_.clock_speed)),
      storage_({.folder = config_.record_folder, .dated_folders = config_.dated_folders}, finalise_, tests_,
               *world_.facts, [this] { boost::asio::post(io_, [this] { tell_status(); }); }),
      watcher_(std::make_unique<Watcher>(*this)),
      retry_after_(world_.first_retry) {}

App::~App() = default;

base::Result<void> App::run() {
  signals_.add(SIGTERM);
  signals_.add(SIGINT);
  signals_.async_wait([this](boost::system::error_code error, int signal) {
    if (!error) stop(signal == SIGINT ? "SIGINT" : "SIGTERM");
  });

  process_facts_ = prepare_process(config_.realtime);
  if (base::Result<void> prepared = prepare_record_folder(); !prepared) return prepared;
  if (config_.control_socket) {
    auto control = ControlServer::listen(io_, *config_.control_socket, make_api([this] { return status(); }));
    if (!control) return tl::unexpected(control.error());
    control_ = std::move(*control);
    world_.facts->control_listening(config_.control_socket->string());
  }
  // What cannot be recovered is told and kept; the measurement goes on.
  static_cast<void>(recover_folder(config_.record_folder, finalise_, *world_.facts));
  if (base::Result<void> opened = open_session(); !opened) {
    if (opened.error().kind == base::ErrorKind::kUsage) return opened;
    wait_for_board(opened.error());
  }
  tell_status();
  // The threads of a session are no work that Asio knows of; leave_when_idle() ends the run.
  const auto until_stopped = boost::asio::make_work_guard(io_);
  io_.run();

  storage_.stop();
  control_.reset();
  return {};
}

void App::request_stop() {
  boost::asio::post(io_, [this] { stop("told to"); });
}

base::Result<void> App::prepare_record_folder() {
  std::error_code error;
  std::filesystem::create_directories(config_.record_folder, error);
  if (error) {
    return base::failure("record folder {}: cannot be made: {}", config_.record_folder.string(),
                         error.message());
  }
  // Permissions, read-only mounts and quotas: only an attempt tells.
  const std::filesystem::path probe = config_.record_folder / fmt::format(".probe-{}", ::getpid());
  const int descriptor = ::open(probe.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    return base::failure("record folder {}: cannot be written: {}", config_.record_folder.string(),
                         std::generic_category().message(errno));
  }
  ::close(descriptor);
  ::unlink(probe.c_str());
  return {};
}

base::Result<void> App::open_session() {
  base::Result<drivers::OpenedBoard> board =
      world_.open_board(config_.board, *clock_, continues_.continuation);
  if (!board) return tl::unexpected(board.error());
  truth_ = board->truth;
  const base::Result<SessionSettings> made = session_settings(*board);
  if (!made) return tl::unexpected(made.error());
  const SessionSettings& settings = *made;
  std::vector<std::string> remarks;
  if (config_.board.driver != drivers::Driver::kReplay) {
    // Not of a replayed record: that is what it is.
    friction::Tester plan = settings.processor.analysis.tester;
    plan.stiffness_N_per_m = config_.bench.stiffness_N_per_m;
    const friction::SamplingVerdict verdict =
        friction::check_sampling(board->board->info().scan_rate_granted_Hz,
                                 friction::expected_frequency_Hz(plan, settings.processor.analysis.prior));
    if (verdict.kind == friction::SamplingVerdict::Kind::kRefused)
      return base::usage_error("[board] scan_rate: {}", verdict.reason);
    world_.facts->sampling_checked(verdict);
    if (!verdict.reason.empty()) remarks.push_back("sampling: " + verdict.reason);
  }

  if (expired(settings.calibration, record::iso_time(clock_->realtime_ns()))) {
    world_.facts->calibration_expired(settings.calibration.expires);
  }

  SessionEvents events;
  events.first_scan = [this] {
    boost::asio::post(io_, [this] {
      if (state_ == State::kStopping) return;
      state_ = State::kAcquiring;
      retry_after_ = world_.first_retry;
      world_.facts->board_started(session_->board_info(), realtime_facts());
      tell_status();
      notify_.ready();
    });
  };
  events.ended = [this](Acquisition::End end) {
    boost::asio::post(io_, [this, end] { session_ended(end); });
  };
  try {
    session_ = std::make_unique<Session>(std::move(*board), settings,
                                         std::vector<pipeline::Sink*>{watcher_.get(), &storage_},
                                         std::move(events), counts_);
  } catch (const std::invalid_argument& refused) {
    return base::usage_error("the board does not suit the configuration: {}", refused.what());
  }
  if (base::Result<void> started = session_->start(); !started) {
    session_.reset();
    return started;
  }
  watcher_->use(truth_.get());
  storage_.use(record_header(settings), truth_.get(), std::move(remarks));
  session_->start_processing();
  return {};
}

void App::wait_for_board(const base::Error& why) {
  state_ = waiting_state(why.kind);
  waiting_why_ = why.message;
  world_.facts->board_unavailable(name(state_), why.message,
                                  std::chrono::duration<double>(retry_after_).count());
  tell_status();
  notify_.ready();
  retry_timer_.expires_after(retry_after_);
  retry_after_ = std::min<std::chrono::milliseconds>(2 * retry_after_, kLongestRetry);
  retry_timer_.async_wait([this](boost::system::error_code error) {
    if (!error && state_ != State::kStopping) retry_board();
  });
}

void App::retry_board() {
  if (base::Result<void> opened = open_session(); !opened) wait_for_board(opened.error());
}

void App::session_ended(Acquisition::End end) {
  const std::string why = session_->board_error();
  SessionEnd ended = session_->end();
  // A session without a scan knows nothing of the index.
  if (!ended.continuation) ended.continuation = continues_.continuation;
  continues_ = ended;
  clocks_ = session_->clocks();
  session_.reset();
  if (state_ == State::kStopping) {
    leave_when_idle();
    return;
  }
  switch (end) {
    case Acquisition::End::kStopped:
    case Acquisition::End::kEndOfInput:
      stop("end of the input");
      break;
    case Acquisition::End::kBoardMissing:
    case Acquisition::End::kFailed:
      ++board_loss_count_;
      // What became of it is told by the next try.
      wait_for_board({base::ErrorKind::kFailure, why.empty() ? "it went away" : why});
      break;
  }
}

void App::stop(const std::string& why) {
  if (state_ == State::kStopping) return;
  state_ = State::kStopping;
  world_.facts->stopping(why);
  notify_.stopping();
  tell_status();
  retry_timer_.cancel();
  if (session_) session_->request_stop();
  leave_when_idle();
}

void App::leave_when_idle() {
  // A running session ends first, and calls again.
  if (!session_) io_.stop();
}

base::Result<SessionSettings> App::session_settings(const drivers::OpenedBoard& opened) const {
  const daq::BoardInfo& board = opened.board->info();
  SessionSettings settings;
  settings.load_cell = config_.bench.load_cell(opened.load_cell);
  // A board that runs faster than time may have no moment to wait, and RLIMIT_RTTIME would end it.
  if (config_.clock_speed == 1.0) settings.realtime = config_.realtime;
  settings.clock_speed = config_.clock_speed;
  settings.processor.first_test_number = continues_.next_test_number;
  if (continues_.continuation) settings.processor.continues_at = continues_.continuation->end;
  settings.processor.recorded = opened.recorded;
  settings.processor.second = board.second;
  const BenchConfig& bench = config_.bench;
  if (bench.calibration) {
    settings.calibration = *bench.calibration;
  } else if (!bench.load_cell_gain_N_per_V && !bench.load_cell_zero_V) {
    settings.calibration = opened.calibration;  // It belongs to the numbers that come with it.
  }
  settings.processor.gain_uncertainty = pipeline::relative_gain_uncertainty(
      settings.load_cell, settings.calibration.gain_standard_error_N_per_V);
  settings.processor.clock_is_real = config_.clock_speed == 1.0;
  settings.processor.segmenter = config_.segmenter;
  settings.processor.segmenter.scan_rate_Hz = board.scan_rate_granted_Hz;
  friction::AnalysisSettings& analysis = settings.processor.analysis;
  analysis.scan_rate_Hz = board.scan_rate_granted_Hz;
  analysis.tester = config_.bench.tester(opened.tester);
  analysis.method = config_.method;
  settings.characterisation =
      config_.bench.characterisation.empty() ? opened.characterisation : config_.bench.characterisation;
  if (!settings.characterisation.empty()) {
    auto coupling = parse_tester(settings.characterisation, "characterisation");
    // The configuration's was checked with it; a record's may be damaged.
    if (!coupling) return tl::unexpected(coupling.error());
    analysis.prior.coupling = *std::move(coupling);
  }
  analysis.estimator = config_.estimator;
  return settings;
}

record::RecordHeader App::record_header(const SessionSettings& settings) const {
  record::RecordHeader header;
  header.board = session_->board_info();
  const daq::RawQuantity quantity = header.board.quantity;
  if (quantity == daq::RawQuantity::kCounts || quantity == daq::RawQuantity::kVolts) {
    header.load_cell = settings.load_cell;
  }
  if (header.load_cell) header.calibration = settings.calibration;
  header.sample = config_.sample;
  const pipeline::SegmenterSettings& segmenter = settings.processor.segmenter;
  header.plan = {segmenter.start_coefficient, segmenter.start_dwell_s,  segmenter.pre_trigger_s,
                 segmenter.end_coefficient,   segmenter.unload_dwell_s, segmenter.no_motion_dwell_s};
  header.tester = record::TesterFacts::of(settings.processor.analysis.tester);
  header.process.program = "stickslipd";
  header.process.version = kVersion;
  header.process.commit = kCommit;
  header.process.configuration = config_.text;
  header.process.method =
      with_estimator(method_text(settings.processor.analysis.method), settings.processor.analysis.estimator);
  header.process.characterisation = settings.characterisation;
  header.process.realtime = realtime_facts();
  return header;
}

std::string App::realtime_facts() const {
  return fmt::format("{}, {}, kernel {}", session_->scheduling(), process_facts_, kernel_preemption());
}

void App::tell_status() {
  const std::string line = status_line();
  notify_.status(line);
  if (world_.status_changed) world_.status_changed(line);
}

std::string_view App::name(State state) noexcept {
  switch (state) {
    case State::kStarting:
      break;
    case State::kAcquiring:
      return "acquiring";
    case State::kBoardMissing:
      return "board missing";
    case State::kBoardBusy:
      return "board busy";
    case State::kNoPermission:
      return "no permission";
    case State::kStopping:
      return "stopping";
  }
  return "starting";
}

App::State App::waiting_state(base::ErrorKind kind) noexcept {
  if (kind == base::ErrorKind::kBusy) return State::kBoardBusy;
  if (kind == base::ErrorKind::kNoPermission) return State::kNoPermission;
  return State::kBoardMissing;
}

std::string App::status_line() const {
  const StorageState storage = storage_.state();
  std::string line = state_line();
  if (storage.kind == StorageState::Kind::kWaiting) {
    line += "; " + storage.why;
  } else if (storage.kind == StorageState::Kind::kShort) {
    line += fmt::format("; storage short: {}; {}", storage.why, storage.to_do);
  } else if (storage.room_h && *storage.room_h < kTellRoom_h) {
    line += fmt::format("; room on the disk for {:.0f} h", *storage.room_h);
  }
  return line;
}

std::string App::state_line() const {
  switch (state_) {
    case State::kAcquiring: {
      const std::string rate =
          session_ ? fmt::format(" at {:.1f} Hz", session_->board_info().scan_rate_granted_Hz) : "";
      const std::string activity = current_test_ ? fmt::format("test {} running", *current_test_) : "idle";
      return fmt::format("acquiring{}, {}, {} tests done", rate, activity, tests_.test_count());
    }
    case State::kBoardMissing:
    case State::kBoardBusy:
    case State::kNoPermission:
      return fmt::format("{}: {}", name(state_), waiting_why_);
    case State::kStarting:
    case State::kStopping:
      break;
  }
  return std::string{name(state_)};
}

Status App::status() const {
  Status status;
  status.state = name(state_);
  status.detail = status_line();
  status.version = kVersion;
  if (session_) {
    status.board = session_->board_info();
    if (current_test_) status.live = session_->live();
    status.scheduling = realtime_facts();
  }
  status.scan_count = counts_.scans.load(std::memory_order_relaxed);
  status.dropped_scan_count = counts_.dropped_scans.load(std::memory_order_relaxed);
  status.overrun_count = counts_.overruns.load(std::memory_order_relaxed);
  status.gap_count = counts_.gaps.load(std::memory_order_relaxed);
  status.lost_scan_count = counts_.lost_scans.load(std::memory_order_relaxed);
  status.board_loss_count = board_loss_count_;
  const SessionClocks clocks = session_ ? session_->clocks() : clocks_;
  if (config_.clock_speed == 1.0) status.scan_rate_measured = clocks.scan_rate;
  status.latency = clocks.latency;
  status.storage_stall_count = storage_.stall_count();
  status.storage = storage_.state();
  if (state_ == State::kAcquiring && status.storage.kind != StorageState::Kind::kOk)
    status.state = fmt::format("storage {}", daemon::name(status.storage.kind));
  status.test_count = tests_.test_count();
  status.current_test = current_test_;
  status.latest_test = tests_.latest();
  return status;
}

}  // namespace stickslip::daemon

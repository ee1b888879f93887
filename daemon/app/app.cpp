#include "daemon/app/app.hpp"

#include <fmt/ranges.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <stdexcept>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include "io/calibration_file.hpp"
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>

#include "core/record/iso_time.hpp"
#include "daemon/control/token.hpp"
#include "daemon/page/site.hpp"
#include "daemon/runtime/session_setup.hpp"
#include "daemon/storage/recovery.hpp"

namespace stickslip::app {
namespace {

/// Longest pause between attempts to open a missing board: 1, 2, 4, 8, 16, 30, 30 … s.
constexpr std::chrono::seconds kLongestRetry{30};

std::unique_ptr<base::Clock> clock_of(const io::DaemonConfig& config) {
  std::unique_ptr<base::Clock> clock = base::make_system_clock(config.clock_speed);
  if (config.board.driver != drivers::Driver::kSimulated || !config.clock_steps_every_s) return clock;
  return base::make_stepping_clock(std::move(clock), *config.clock_steps_every_s,
                                   config.board.simulated.faults.seed);
}

/// Makes the record read-only, if its permissions can be changed.
storage::Finalise read_only(storage::Finalise finalise) {
  return [finalise = std::move(finalise)](const std::filesystem::path& journal,
                                          std::optional<std::int64_t> expected) {
    auto made = finalise(journal, expected);
    constexpr mode_t kNobodyWrites = 0444;
    // The record is whole; that it can be written to is no reason to refuse it.
    if (made) static_cast<void>(::chmod(made->file.c_str(), kNobodyWrites));
    return made;
  };
}

}  // namespace

App::App(io::DaemonConfig config, AppWorld world)
    : config_(std::move(config)),
      world_(std::move(world)),
      signals_(io_),
      retry_timer_(io_),
      reload_timer_(io_),
      finalise_(config_.read_only_records ? read_only(world_.finalise) : world_.finalise),
      clock_(world_.clock ? std::move(world_.clock) : clock_of(config_)),
      storage_(
          {.folder = config_.record_folder, .dated_folders = config_.dated_folders}, finalise_, tests_,
          *world_.events, [this] { boost::asio::post(io_, [this] { tell_status(); }); },
          [this](std::int64_t test, const base::Result<std::filesystem::path>& file) {
            boost::asio::post(io_, [this, test, file] {
              if (file) {
                batches_.record_published(test, *file);
                charts_.record_published(*file);
              } else {
                batches_.record_failed(test);
              }
            });
          }),
      watcher_(
          tests_, *world_.events,
          [this](std::optional<std::int64_t> number) {
            boost::asio::post(io_, [this, number] {
              current_test_ = number;
              if (number) batches_.test_began(*number);
              tell_status();
            });
          },
          [this] {
            if (reload_at_rest_.exchange(false)) reload_at_rest(*session_);
          }),
      live_(io_, *clock_, [this] { return daemon::health_frame(asked_status()); }),
      batches_({.folder = config_.record_folder,
                .program = "/proc/self/exe",
                .plan = [this] { return commands_.plan(); },
                .set_plan = [this](daemon::Plan plan) { commands_.set_plan(std::move(plan)); },
                .earlier = [this](daemon::TestSummary test) { tests_.add_earlier(std::move(test)); },
                .on_main = [this](std::function<void()> done) { boost::asio::post(io_, std::move(done)); },
                .clock = clock_.get()}),
      charts_({.folder = config_.record_folder,
               .reference = config_.trend_reference,
               .alarmed = [this](const base::Finding& finding) { world_.events->trend_alarmed(finding); },
               .troubled = [this](const std::string& why) { world_.events->trend_troubled(why); },
               .clock = clock_.get()}),
      reports_({.io = io_, .folder = config_.record_folder, .program = page::program_beside_this()}),
      wall_(base::make_system_clock()),
      calibrations_(
          {.config = config_,
           .storage = storage_,
           .events = *world_.events,
           .session = [this] { return session_.get(); },
           .on_main = [this](std::function<void()> done) { boost::asio::post(io_, std::move(done)); },
           .date_ns = [this] { return wall_->realtime_ns(); },
           .now_ns = [this] { return clock_->realtime_ns(); }}),
      commands_({.config = config_,
                 .tests = tests_,
                 .storage = storage_,
                 .calibrations = calibrations_,
                 .status = [this] { return asked_status(); },
                 .session = [this] { return session_.get(); },
                 .on_main = [this](std::function<void()> done) { boost::asio::post(io_, std::move(done)); },
                 .batches = &batches_,
                 .reports = &reports_,
                 .trend =
                     [this](std::function<void(std::string)> answer) {
                       charts_.ask([this, answer = std::move(answer)](std::string text) {
                         boost::asio::post(io_, [answer, text = std::move(text)] { answer(text); });
                       });
                     }}),
      watchdog_(io_, runtime::Notify::watchdog_interval(), watched_parts(),
                {.feed = [this] { notify_.alive(); },
                 .hanging =
                     [this](const std::vector<std::string>& parts) {
                       world_.events->hanging(fmt::format("{}", fmt::join(parts, ", ")));
                       tell_status();
                     }}),
      retry_after_(world_.first_retry) {}

App::~App() = default;

base::Result<void> App::run() {
  signals_.add(SIGTERM);
  signals_.add(SIGINT);
  if (world_.check_config) signals_.add(SIGHUP);
  wait_for_signal();
  if (world_.stop_asked && world_.stop_asked()) request_stop();

  process_facts_ = runtime::prepare_process(config_.realtime);
  for (const std::string& lack : world_.record_folder.lacks) world_.events->record_folder_lacks(lack);
  if (base::Result<void> opened = open_control(); !opened) return opened;
  // What cannot be recovered is told and kept; the measurement goes on.
  static_cast<void>(storage::recover_folder(config_.record_folder, finalise_, *world_.events));
  batches_.open();
  continues_.next_test_number = batches_.next_test_number();
  charts_.open();
  if (base::Result<void> opened = open_fleet(); !opened) return opened;
  if (base::Result<void> opened = open_session();
      !opened && opened.error().kind != base::ErrorKind::kInterrupted) {
    if (opened.error().kind == base::ErrorKind::kUsage) return opened;
    wait_for_board(opened.error());
  }
  tell_status();
  // The threads of a session are no work that Asio knows of; leave_when_idle() ends the run.
  const auto until_stopped = boost::asio::make_work_guard(io_);
  io_.run();

  storage_.stop();
  world_.events->scans_accounted(scan_account());
  // What the last record means for its batch.
  io_.restart();
  io_.poll();
  batches_.close();
  charts_.close();
  io_.poll();
  if (fleet_) fleet_->stop();
  live_.close();
  control_.clear();
  return {};
}

void App::tell_ready() {
  notify_.ready();
  watchdog_.start();
}

void App::request_stop() {
  boost::asio::post(io_, [this] { stop("told to"); });
}

base::Result<void> App::open_control() {
  if (!config_.control_socket && config_.http.empty()) return {};
  const daemon::HttpHandler api =
      page::make_site(control::make_api(commands_, *wall_, lease_), report::read_chart_library());
  const auto keep =
      [this](base::Result<std::unique_ptr<control::ControlServer>> server) -> base::Result<void> {
    if (!server) return tl::unexpected(server.error());
    world_.events->control_listening((*server)->address());
    control_.push_back(*std::move(server));
    return {};
  };
  if (config_.control_socket) {
    auto kept = keep(control::ControlServer::listen(io_, *config_.control_socket, api, {}, &live_.hub()));
    if (!kept || config_.http.empty()) return kept;
  }
  const base::Result<std::string> token = control::load_token(config_.token_file);
  if (!token) return tl::unexpected(token.error());
  if (auto kept = keep(control::ControlServer::listen_tcp(io_, config_.http, *token, api, {}, &live_.hub()));
      !kept)
    return kept;
  page_ = daemon::Status::Page{fmt::format("http://{}/", control_.back()->address()),
                               std::filesystem::absolute(config_.token_file).lexically_normal().string()};
  return {};
}

base::Result<void> App::open_fleet() {
  if (!config_.fleet) return {};
  if (base::Result<void> readable = io::check_files(*config_.fleet); !readable) return readable;
  fleet_ = std::make_unique<fleet::Fleet>(
      io_, *config_.fleet,
      fleet::Fleet::Parts{
          .status = [this] { return status(); },
          .wall = *wall_,
          .events = *world_.events,
          .record_folder = config_.record_folder,
          .program = "/proc/self/exe",
          .set_facts = [this](record::Metadata facts) { commands_.set_told_facts(std::move(facts)); }});
  storage_.tell_ends([this](const record::RecordHeader& header, const record::EndRecord& end,
                            const std::filesystem::path& file) { fleet_->test_recorded(header, end, file); });
  return {};
}

std::vector<pipeline::Sink*> App::sinks() {
  std::vector<pipeline::Sink*> sinks{&watcher_, &storage_, &live_.feed()};
  if (fleet_) sinks.push_back(fleet_.get());
  return sinks;
}

base::Result<void> App::open_session() {
  base::Result<drivers::OpenedBoard> board = world_.open_board(config_.board, *clock_, continues_.before);
  if (!board) return tl::unexpected(board.error());
  truth_ = board->truth;
  const base::Result<runtime::SessionSettings> made = runtime::session_settings(config_, *board, continues_);
  if (!made) return tl::unexpected(made.error());
  const runtime::SessionSettings& settings = *made;
  const auto verdict = runtime::check_sampling(config_, settings);
  if (!verdict) return tl::unexpected(verdict.error());
  world_.events->sampling_checked(*verdict);
  std::vector<std::string> remarks;
  if (!verdict->reason.empty()) remarks.push_back("sampling: " + verdict->reason);

  if (io::expired(settings.calibration, record::iso_time(clock_->realtime_ns()))) {
    world_.events->calibration_expired(settings.calibration.expires);
  }

  runtime::SessionEvents events;
  events.first_scan = [this] {
    boost::asio::post(io_, [this] {
      if (state_ == State::kStopping) return;
      state_ = State::kAcquiring;
      retry_after_ = world_.first_retry;
      world_.events->board_started(session_->board_info(), realtime_facts());
      tell_status();
      tell_ready();
    });
  };
  events.block = [this](const daq::ScanBlock& block) { calibrations_.block(block); };
  events.ended = [this](runtime::Acquisition::End end) {
    calibrations_.blocks_ended();
    boost::asio::post(io_, [this, end] { session_ended(end); });
  };
  try {
    session_ =
        std::make_unique<runtime::Session>(std::move(*board), settings, sinks(), std::move(events), counts_);
  } catch (const std::invalid_argument& refused) {
    return base::usage_error("the board does not suit the configuration: {}", refused.what());
  }
  if (base::Result<void> started = session_->start(); !started) {
    session_.reset();
    return started;
  }
  calibrations_.session_began(settings);
  sled_mass_kg_ = settings.processor.analysis.tester.sled_mass_kg;
  watcher_.use(truth_.get(), settings.processor.analysis.skipped.first_slip);
  live_.feed().use(settings.processor.analysis.scan_rate_Hz, config_.clock_speed);
  record::RecordHeader header =
      runtime::record_header(config_, settings, session_->board_info(), realtime_facts());
  header.sample.metadata = commands_.next_facts();
  storage_.use(std::move(header), truth_.get(), std::move(remarks));
  session_->start_processing();
  return {};
}

void App::wait_for_board(const base::Error& why) {
  state_ = waiting_state(why.kind);
  waiting_why_ = why.message;
  world_.events->board_unavailable(name(state_), why.message,
                                   std::chrono::duration<double>(retry_after_).count());
  tell_status();
  tell_ready();
  retry_timer_.expires_after(retry_after_);
  retry_after_ = std::min<std::chrono::milliseconds>(2 * retry_after_, kLongestRetry);
  retry_timer_.async_wait([this](boost::system::error_code error) {
    if (!error && state_ != State::kStopping) retry_board();
  });
}

void App::retry_board() {
  if (base::Result<void> opened = open_session(); !opened) wait_for_board(opened.error());
}

void App::session_ended(runtime::Acquisition::End end) {
  const std::string why = session_->board_error();
  runtime::SessionEnd ended = session_->end();
  // A session without a scan knows nothing of the index.
  if (!ended.before.continuation) ended.before.continuation = continues_.before.continuation;
  continues_ = ended;
  clocks_ = session_->clocks();
  issued_before_ += session_->issued_index_count();
  session_.reset();
  calibrations_.session_ended();
  if (state_ == State::kStopping) {
    leave_when_idle();
    return;
  }
  switch (end) {
    case runtime::Acquisition::End::kStopped:
    case runtime::Acquisition::End::kEndOfInput:
      stop("end of the input");
      break;
    case runtime::Acquisition::End::kBoardMissing:
    case runtime::Acquisition::End::kFailed:
      ++board_loss_count_;
      // What became of it is told by the next try.
      wait_for_board({base::ErrorKind::kFailure, why.empty() ? "it went away" : why});
      if (reload_asked_) reload_when_idle();
      break;
  }
}

void App::stop(const std::string& why) {
  if (state_ == State::kStopping) return;
  state_ = State::kStopping;
  world_.events->stopping(why);
  if (!reloads_) notify_.stopping();
  tell_status();
  retry_timer_.cancel();
  reload_timer_.cancel();
  if (session_) session_->request_stop();
  leave_when_idle();
}

void App::leave_when_idle() {
  // A running session ends first, and calls again.
  if (!session_) io_.stop();
}

std::string App::realtime_facts() const {
  return fmt::format("{}, {}, kernel {}", session_->scheduling(), process_facts_,
                     runtime::kernel_preemption());
}

void App::tell_status() {
  const std::string line = status_line();
  notify_.status(line);
  if (world_.status_changed) world_.status_changed(line);
  if (fleet_) fleet_->state_changed();
}

}  // namespace stickslip::app

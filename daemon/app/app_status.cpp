// How the daemon is: its state in a word, a line for people, all of it, and what its watchdog looks at.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/version.hpp"
#include "core/pipeline/plausibility.hpp"
#include "core/pipeline/test_facts.hpp"
#include "daemon/app/app.hpp"

namespace stickslip::app {
namespace {

/// The status line tells the room on the disk below this time of scanning only, h: 30 days.
constexpr double kTellRoom_h = 720.0;

}  // namespace

std::vector<runtime::WatchedPart> App::watched_parts() {
  // Without scans the state of the daemon says why: no board, or it begins or ends.
  const auto of_scans = [this](std::uint64_t count) {
    return runtime::Pulse{count, !session_ || state_ != State::kAcquiring};
  };
  // A late system call means a slow disk, not a hanging thread: the kernel retries for three minutes before
  // it reports a failing disk (sd: 30 s, six times), and memory holds ten minutes of scans.
  constexpr int kDiskPatience = 4;
  return {
      {"acquisition", [=, this] { return of_scans(session_ ? session_->delivered_scan_count() : 0); }},
      {"detector", [=, this] { return of_scans(counts_.scans.load(std::memory_order_relaxed)); }},
      {"storage", [this] { return runtime::Pulse{storage_.storage_rounds()}; }, kDiskPatience},
      {"disk", [this] { return runtime::Pulse{storage_.disk_rounds()}; }, kDiskPatience},
  };
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
  const daemon::StorageState storage = storage_.state();
  std::string line = state_line();
  if (session_) {
    if (const std::string_view trouble = pipeline::words(session_->bench_trouble()); !trouble.empty())
      line += fmt::format("; bench {}: {}", pipeline::name(session_->bench()), trouble);
  }
  if (!watchdog_.hanging().empty())
    line += fmt::format("; does not move: {}", fmt::join(watchdog_.hanging(), ", "));
  if (storage.kind == daemon::StorageState::Kind::kWaiting) {
    line += "; " + storage.why;
  } else if (storage.kind == daemon::StorageState::Kind::kShort) {
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

daemon::ScanAccount App::scan_account() const {
  daemon::ScanAccount account;
  account.issued = issued_before_ + (session_ ? session_->issued_index_count() : 0);
  account.idle = counts_.idle_scans.load(std::memory_order_relaxed);
  const storage::DiskWriter::ScanCounts stored = storage_.scan_counts();
  account.in_gaps = counts_.lost_scans.load(std::memory_order_relaxed) + stored.lost;
  account.recorded = stored.recorded;
  account.damaged = stored.damaged;
  account.unsaved = stored.unsaved;
  return account;
}

daemon::Status App::asked_status() {
  charts_.look();
  return status();
}

daemon::Status App::status() const {
  daemon::Status status;
  status.state = name(state_);
  status.detail = status_line();
  status.version = base::kVersion;
  if (session_) {
    status.board = session_->board_info();
    status.bench = session_->bench();
    status.bench_trouble = pipeline::words(session_->bench_trouble());
    if (current_test_) status.live = session_->live();
    status.scheduling = realtime_facts();
  }
  status.scan_count = counts_.scans.load(std::memory_order_relaxed);
  status.dropped_scan_count = counts_.dropped_scans.load(std::memory_order_relaxed);
  status.overrun_count = counts_.overruns.load(std::memory_order_relaxed);
  status.gap_count = counts_.gaps.load(std::memory_order_relaxed);
  status.lost_scan_count = counts_.lost_scans.load(std::memory_order_relaxed);
  status.board_loss_count = board_loss_count_;
  status.scans = scan_account();
  const runtime::SessionClocks clocks = session_ ? session_->clocks() : clocks_;
  if (config_.clock_speed == 1.0) status.scan_rate_measured = clocks.scan_rate;
  status.latency = clocks.latency;
  if (session_) status.ring = session_->ring_use();
  status.commit_time = storage_.commit_time();
  status.storage_stall_count = storage_.stall_count();
  status.storage = storage_.state();
  status.storage.lacks = world_.record_folder.lacks;
  status.batch = batches_.progress();
  if (state_ == State::kAcquiring && status.storage.kind != daemon::StorageState::Kind::kOk)
    status.state = fmt::format("storage {}", daemon::name(status.storage.kind));
  status.test_count = tests_.test_count();
  status.current_test = current_test_;
  status.latest_test = tests_.latest();
  const daemon::CalibrationView calibration = calibrations_.view();
  status.calibration = {calibration.facts.date, calibration.facts.expires, calibration.expired,
                        calibration.session ? calibration.session->who : std::string{}};
  status.lease = lease_.state(wall_->monotonic_ns());
  if (sled_mass_kg_) {
    if (auto finding = pipeline::sled_finding(*sled_mass_kg_))
      base::add(status.findings, *std::move(finding));
  }
  if (calibration.expired) base::add(status.findings, pipeline::expired_finding(calibration.facts.expires));
  status.trend = charts_.state();
  for (const base::Finding& finding : status.trend.findings) base::add(status.findings, finding);
  status.finding_counts = tests_.finding_counts();
  status.page = page_;
  if (fleet_) status.fleet = fleet_->state();
  status.facts = commands_.next_facts();
  status.live_client_count = static_cast<std::int64_t>(live_.hub().client_count());
  status.live_dropped_count = live_.hub().dropped_count() + live_.lost_count();
  return status;
}

}  // namespace stickslip::app

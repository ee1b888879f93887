#include "daemon/storage/disk_writer.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "core/base/thread_name.hpp"
#include "core/record/file.hpp"

namespace stickslip::storage {
namespace {

/// Size of the ballast, bytes: 90 minutes of 16-bit counts at 350 scans/s, and the record of a short test.
constexpr std::int64_t kBallast = std::int64_t{4} << 20U;
constexpr double kSecondsPerHour = 3600.0;
constexpr double kSecondsPerMinute = 60.0;

}  // namespace

Ballast::Ballast(const std::filesystem::path& folder, const record::FileCalls& calls)
    : path_(folder / ".stickslip-ballast"), calls_(calls) {
  take();
}

Ballast::~Ballast() {
  if (kept_) calls_.unlink(path_.c_str());
}

bool Ballast::give() {
  if (!kept_) return false;
  kept_ = false;
  return calls_.unlink(path_.c_str()) == 0;
}

void Ballast::take() {
  constexpr std::int64_t kPlenty = 4 * kBallast;
  // It may have gone with its folder.
  struct stat found {};
  if (kept_ && calls_.lstat(path_.c_str(), &found) != 0 && errno == ENOENT) kept_ = false;
  if (kept_ || calls_.room(path_.parent_path().c_str()) < kPlenty) return;
  constexpr mode_t kMode = 0600;
  // What a kill left is given back first; a link is removed, not followed.
  calls_.unlink(path_.c_str());
  const record::Descriptor file{
      calls_.open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kMode)};
  kept_ = file.open();
  // Where the file system cannot reserve, there is no ballast.
  if (kept_ && calls_.reserve(file.get(), 0, kBallast) != 0) give();
}

DiskWriter::DiskWriter(Settings settings, Ended ended, std::function<void(const DiskState&)> changed)
    : settings_(std::move(settings)),
      ended_(std::move(ended)),
      changed_(std::move(changed)),
      folder_watch_(settings_.folder, *settings_.calls),
      ballast_(settings_.folder, *settings_.calls),
      thread_([this] { run(); }) {}

DiskWriter::~DiskWriter() { stop(); }

void DiskWriter::begin(std::int64_t test, Journal journal) {
  {
    const std::lock_guard lock{mutex_};
    jobs_.push_back({test, std::move(journal)});
  }
  wake();
}

void DiskWriter::wake() {
  {
    const std::lock_guard lock{mutex_};
    has_news_ = true;
  }
  woken_.notify_one();
}

void DiskWriter::end(const Journal& journal) {
  {
    const std::lock_guard lock{mutex_};
    for (Job& job : jobs_) {
      if (job.journal == journal) job.ended = true;
    }
  }
  wake();
}

DiskState DiskWriter::state() const {
  const std::lock_guard lock{mutex_};
  return state_;
}

std::size_t DiskWriter::waiting_size() const {
  const std::lock_guard lock{mutex_};
  std::size_t size = 0;
  for (const Job& job : jobs_) size += job.journal->waiting_size();
  return size;
}

std::optional<double> DiskWriter::room_s() const {
  const std::int64_t room = settings_.calls->room(settings_.folder.c_str());
  const double load = load_bytes_per_s_;
  if (room < 0 || !(load > 0.0)) return std::nullopt;
  return static_cast<double>(room) / load;
}

void DiskWriter::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock{mutex_};
    stopping_ = true;
  }
  woken_.notify_one();
  thread_.join();
}

void DiskWriter::run() {
  Time last_sync = Clock::now();
  std::optional<Time> stopping_since;
  std::optional<std::string> trouble;
  base::name_this_thread("disk");
  for (;;) {
    rounds_.fetch_add(1, std::memory_order_relaxed);
    {
      std::unique_lock lock{mutex_};
      // A disk that refused is asked again after a while, not for each entry.
      const bool refused = trouble.has_value();
      woken_.wait_for(lock, refused ? settings_.retry_period : settings_.sync_period,
                      [&] { return (stopping_ && !stopping_since) || (has_news_ && !refused); });
      has_news_ = false;
      if (stopping_ && !stopping_since) stopping_since = Clock::now();
    }
    const bool sync = stopping_since || trouble || Clock::now() - last_sync >= settings_.sync_period;
    trouble = write_all(sync);
    // What was begun may use what was kept back for it.
    if (trouble && !away_ && ballast_.give()) trouble = write_all(true);
    if (sync || trouble) {
      last_sync = Clock::now();
      if (!trouble) ballast_.take();
      tell(trouble);
    }
    if (!stopping_since) continue;
    if (trouble && Clock::now() - *stopping_since >= settings_.patience) {
      give_up(*trouble);
      return;
    }
    const std::lock_guard lock{mutex_};
    if (jobs_.empty() || (!trouble && std::none_of(jobs_.begin(), jobs_.end(), [](const Job& job) {
          return job.ended && !job.handed_over;
        }))) {
      return;
    }
  }
}

DiskWriter::ScanCounts DiskWriter::scan_counts() const {
  const std::lock_guard lock{mutex_};
  ScanCounts scans = scans_;
  for (const Job& job : jobs_) {
    if (!job.handed_over || job.trouble) continue;
    scans.recorded += job.journal->kept_scan_count();
    scans.lost += job.journal->lost_scan_count();
  }
  return scans;
}

base::Result<record::Finalised> DiskWriter::make_record(
    std::int64_t test,
    const std::function<base::Result<record::Finalised>(const std::filesystem::path& journal)>& make) {
  const auto find = [&] {
    return std::find_if(jobs_.begin(), jobs_.end(), [test](const Job& kept) { return kept.test == test; });
  };
  std::shared_ptr<std::mutex> claim;
  {
    const std::lock_guard lock{mutex_};
    if (const auto job = find(); job != jobs_.end()) claim = job->claim;
  }
  if (!claim) return base::failure("test {}: has no journal any more", test);
  const std::lock_guard claimed{*claim};
  Journal journal;
  {
    const std::lock_guard lock{mutex_};
    const auto job = find();
    if (job == jobs_.end()) return base::failure("test {}: has no journal any more", test);
    if (job->trouble) return base::failure("{}", *job->trouble);
    journal = job->journal;
  }
  base::Result<record::Finalised> made = make(journal->path());
  if (made) finished(test);
  return made;
}

void DiskWriter::finished(std::int64_t test) {
  const std::lock_guard lock{mutex_};
  const auto job = std::find_if(jobs_.begin(), jobs_.end(),
                                [test](const Job& kept) { return kept.test == test && kept.handed_over; });
  if (job == jobs_.end()) return;
  scans_.recorded += job->journal->kept_scan_count();
  scans_.lost += job->journal->lost_scan_count();
  jobs_.erase(job);
}

void DiskWriter::close_account() {
  const bool away = folder_watch_.look().has_value();
  const std::lock_guard lock{mutex_};
  for (const Job& job : std::exchange(jobs_, {})) {
    if (!job.handed_over) continue;
    std::int64_t& count = away || job.journal->ensure_at_path() ? scans_.unsaved : scans_.recorded;
    count += job.journal->kept_scan_count();
    scans_.lost += job.journal->lost_scan_count();
  }
}

daq::LatencyHistogram DiskWriter::commit_time() const {
  const std::lock_guard lock{mutex_};
  return commit_time_;
}

std::optional<std::string> DiskWriter::write_all(bool sync) {
  std::vector<Job> jobs;
  {
    const std::lock_guard lock{mutex_};
    jobs.assign(jobs_.begin(), jobs_.end());
  }
  away_ = folder_watch_.look();
  std::optional<std::string> trouble;
  if (away_) trouble = away_->why;
  const auto is_finished = [this](const Job& job) {
    const std::lock_guard lock{mutex_};
    return std::none_of(jobs_.begin(), jobs_.end(),
                        [&job](const Job& kept) { return kept.journal == job.journal; });
  };
  for (const Job& job : jobs) {
    const std::unique_lock claimed{*job.claim, std::try_to_lock};
    // Its record is being made or was made meanwhile, and the journal removed.
    if (job.handed_over && (!claimed || is_finished(job))) continue;
    // One that cannot be written holds up no other.
    const std::optional<std::string> refused =
        away_ ? away_->why : write(job, sync || (job.ended && !job.handed_over));
    {
      const std::lock_guard lock{mutex_};
      for (Job& kept : jobs_) {
        if (kept.journal == job.journal) kept.trouble = refused;
      }
    }
    if (refused && !trouble) trouble = refused;
    if (!refused && job.ended && !job.handed_over) hand_over(job);
  }
  return trouble;
}

void DiskWriter::hand_over(const Job& job) {
  job.journal->hand_over();
  const std::filesystem::path path = job.journal->path();
  {
    const std::lock_guard lock{mutex_};
    for (Job& kept : jobs_) {
      if (kept.journal == job.journal) kept.handed_over = true;
    }
  }
  ended_(job.test, path, job.journal->kept_scan_count(), std::nullopt);
}

std::optional<std::string> DiskWriter::write(const Job& job, bool sync) {
  if (job.handed_over && !sync) return job.trouble;
  if (!sync) return job.journal->write();
  const std::filesystem::path before = job.journal->path();
  const int anew = job.journal->anew_count();
  std::optional<std::string> trouble;
  if (job.journal->saved()) {
    trouble = job.journal->ensure_at_path();
  } else {
    const Time began = Clock::now();
    trouble = job.journal->save();
    const std::chrono::nanoseconds took = Clock::now() - began;
    if (!trouble) {
      const std::lock_guard lock{mutex_};
      commit_time_.add(static_cast<double>(took.count()));
    }
  }
  if (job.journal->anew_count() > anew && settings_.written_anew)
    settings_.written_anew(job.test, before, job.journal->path());
  return trouble;
}

void DiskWriter::tell(std::optional<std::string> trouble) {
  DiskState state;
  state.trouble = std::move(trouble);
  if (away_) state.to_do = away_->to_do;
  const auto room = away_ ? std::nullopt : room_s();
  if (room) {
    const double unit_s = *room < kSecondsPerHour ? kSecondsPerMinute : kSecondsPerHour;
    state.room_h = std::floor(*room / unit_s) * unit_s / kSecondsPerHour;
  }
  bool news = false;
  {
    const std::lock_guard lock{mutex_};
    if (state.trouble) {
      for (const Job& job : jobs_) state.waiting_size += job.journal->waiting_size();
    }
    state.is_short = room && *room < (state_.is_short ? kRoomAgain_s : kLeastRoom_s);
    news = !(state == state_);
    state_ = state;
  }
  if (news) changed_(state);
}

void DiskWriter::give_up(const std::string& why) {
  std::vector<Job> lost;
  {
    const std::lock_guard lock{mutex_};
    // What was handed over may still come back: close_account().
    const auto is_lost = [](const Job& job) { return !job.handed_over; };
    std::copy_if(jobs_.begin(), jobs_.end(), std::back_inserter(lost), is_lost);
    jobs_.remove_if(is_lost);
    for (const Job& job : lost) {
      scans_.unsaved += job.journal->kept_scan_count();
      scans_.lost += job.journal->lost_scan_count();
    }
  }
  for (const Job& job : lost)
    ended_(job.test, job.journal->path(), job.journal->kept_scan_count(), job.trouble.value_or(why));
}

}  // namespace stickslip::storage

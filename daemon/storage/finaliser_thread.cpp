#include "daemon/storage/finaliser_thread.hpp"

#include <algorithm>
#include <utility>

#include "core/base/thread_name.hpp"

namespace stickslip::storage {
namespace {

/// Longest pause between two attempts for one journal.
constexpr std::chrono::minutes kLongestPause{10};

}  // namespace

Finisher::Finisher(Make make, Done done, std::chrono::milliseconds first_retry)
    : make_(std::move(make)), done_(std::move(done)), first_retry_(first_retry), thread_([this] { run(); }) {}

Finisher::~Finisher() { stop(); }

void Finisher::finish(std::int64_t test, std::int64_t scans) {
  {
    const std::lock_guard lock{mutex_};
    jobs_.push_back({test, scans, {}, first_retry_, {}});
  }
  news_.notify_one();
}

void Finisher::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock{mutex_};
    stopping_ = true;
  }
  news_.notify_one();
  thread_.join();
}

std::optional<Finisher::Job> Finisher::next() {
  std::unique_lock lock{mutex_};
  for (;;) {
    const auto first = std::min_element(jobs_.begin(), jobs_.end(),
                                        [](const Job& a, const Job& b) { return a.due < b.due; });
    if (first == jobs_.end()) {
      if (stopping_) return std::nullopt;
      news_.wait(lock);
    } else if (stopping_ || first->due <= std::chrono::steady_clock::now()) {
      Job job = std::move(*first);
      job.is_last = stopping_;
      jobs_.erase(first);
      return job;
    } else {
      const Time due = first->due;
      news_.wait_until(lock, due);
    }
  }
}

void Finisher::run() {
  base::name_this_thread("finisher");
  while (std::optional<Job> job = next()) {
    const base::Result<record::Finalised> file = make_(job->test, job->scans);
    const std::string refused = file ? std::string{} : file.error().message;
    // The same refusal is told once.
    if (file || refused != job->refused) done_(job->test, job->scans, file);
    if (file || job->is_last) continue;
    job->refused = refused;
    job->due = std::chrono::steady_clock::now() + job->pause;
    job->pause = std::min<std::chrono::milliseconds>(2 * job->pause, kLongestPause);
    const std::lock_guard lock{mutex_};
    jobs_.push_back(*std::move(job));
  }
}

}  // namespace stickslip::storage

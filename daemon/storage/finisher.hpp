/// \file
/// The thread that makes records of ended journals, so that none of it holds up the writing.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "daemon/storage/recovery.hpp"

namespace stickslip::storage {

class Finisher {
 public:
  /// \param scans  that were written to the journal.
  using Done =
      std::function<void(std::int64_t test, std::int64_t scans, const base::Result<record::Finalised>&)>;

  /// Where the journal of a test stands now, or why it does not.
  using Where = std::function<base::Result<std::filesystem::path>(std::int64_t test)>;

  /// \param where  asked on the thread before each attempt; a journal that is away is waited for.
  /// \param finalise  called on the thread. \param done  too, after each attempt that gave something new.
  /// \param first_retry  after a failure; then twice as long each time.
  Finisher(Finalise finalise, Done done, Where where,
           std::chrono::milliseconds first_retry = std::chrono::seconds{5});
  ~Finisher();
  Finisher(const Finisher&) = delete;
  Finisher& operator=(const Finisher&) = delete;

  /// \param scans  that were written to the journal. Any thread.
  void finish(std::int64_t test, std::int64_t scans);

  /// Tries each of those that are left once more, ends the thread. What could not be made is told.
  void stop();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Job {
    std::int64_t test;
    std::int64_t scans;
    Time due;
    std::chrono::milliseconds pause;
    std::string refused;   ///< What was told last.
    bool is_last = false;  ///< Taken when all was to end.
  };

  void run();
  /// The next job that is due, once there is one; nothing to end.
  [[nodiscard]] std::optional<Job> next();

  Finalise finalise_;
  Done done_;
  Where where_;
  std::chrono::milliseconds first_retry_;
  std::mutex mutex_;
  std::condition_variable news_;
  std::deque<Job> jobs_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace stickslip::storage

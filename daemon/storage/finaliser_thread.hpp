/// \file
/// The finisher's thread: makes the records of ended journals, so that it does not delay the disk thread.
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
  /// Called after an attempt to make a record. \param scans  number of scans written to the journal.
  using Done =
      std::function<void(std::int64_t test, std::int64_t scans, const base::Result<record::Finalised>&)>;

  /// Makes the record of a test from its journal.
  using Make = std::function<base::Result<record::Finalised>(std::int64_t test, std::int64_t scans)>;

  /// Starts the thread.
  /// \param make  called on the thread. \param done  called on the thread after each attempt, but not if it
  /// failed for the same reason as the one before. \param first_retry  pause after the first failure. It
  /// doubles with each failure, up to 10 min.
  Finisher(Make make, Done done, std::chrono::milliseconds first_retry = std::chrono::seconds{5});
  ~Finisher();
  Finisher(const Finisher&) = delete;
  Finisher& operator=(const Finisher&) = delete;

  /// Queues a journal; does not block. Any thread. \param scans  number of scans written to the journal.
  void finish(std::int64_t test, std::int64_t scans);

  /// Tries each waiting journal once more, ends the thread; blocks. `done` reports the failures.
  void stop();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Job {
    std::int64_t test;
    std::int64_t scans;
    Time due;
    std::chrono::milliseconds pause;
    std::string refused;   ///< The reason reported last.
    bool is_last = false;  ///< Taken after stop(): no retry.
  };

  void run();
  /// Blocks until a job is due and returns it; nothing: the thread is to end.
  [[nodiscard]] std::optional<Job> next();

  Make make_;
  Done done_;
  std::chrono::milliseconds first_retry_;
  std::mutex mutex_;
  std::condition_variable news_;
  std::deque<Job> jobs_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace stickslip::storage

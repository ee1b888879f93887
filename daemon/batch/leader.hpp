/// \file
/// Runs the current batch: sets the plan of the next test, writes recorded tests to the batch journal, and
/// resumes the batch after a restart.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/thread_pool.hpp>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "daemon/types/batch.hpp"
#include "daemon/types/batch_journal.hpp"
#include "daemon/types/batches.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::batch {

/// Main thread. After open(), a thread inside appends to the journal and reads records (in child processes);
/// only close() waits for it.
class BatchLeader final : public daemon::Batches {
 public:
  struct Parts {
    std::filesystem::path folder;  ///< The record folder.
    std::string program;           ///< Path of stickslipd, for place_of().
    /// Returns the plan of the coming tests.
    std::function<daemon::Plan()> plan;
    /// Sets the plan of the coming tests.
    std::function<void(daemon::Plan)> set_plan;
    /// Called on the main thread with each test of the batch that an earlier run of the program recorded; may
    /// be empty.
    std::function<void(daemon::TestSummary)> earlier;
    std::function<void(std::function<void()>)> on_main;  ///< Runs a function on the main thread. Any thread.
    const base::Clock* clock;                            ///< Outlives this object.
  };
  explicit BatchLeader(Parts parts);
  /// As close().
  ~BatchLeader() override;
  BatchLeader(const BatchLeader&) = delete;
  BatchLeader& operator=(const BatchLeader&) = delete;

  /// Call it once, after recovery. Reads the journal, adds records of the current batch that the journal
  /// lacks, and sets the plan of the next test; blocks. Parts::earlier is then called for each test of the
  /// current batch, one by one, without blocking.
  void open();
  /// One more than the highest test number in the current batch; 1 without a batch.
  [[nodiscard]] std::int64_t next_test_number() const;

  /// Blocks until the pending writes are done. Changes requested later are not written.
  void close();

  // Events of tests.
  void test_began(std::int64_t number);
  void record_published(std::int64_t number, const std::filesystem::path& file);
  void record_failed(std::int64_t number);

  [[nodiscard]] const daemon::BatchBook& book() override;
  [[nodiscard]] std::optional<daemon::BatchProgress> progress() const override;
  [[nodiscard]] std::string name_of(const std::filesystem::path& record) const override;
  void begin(daemon::BatchPlan plan, std::string who, Answer answer) override;
  void end(std::string who, Answer answer) override;
  void void_test(const std::string& record, std::string reason, std::string who, Answer answer) override;
  void restore(const std::string& record, std::string who, Answer answer) override;

 private:
  [[nodiscard]] std::string now() const;
  [[nodiscard]] std::optional<daemon::BatchStep> next() const;
  /// Appends an event on the pool's thread. Then, on the main thread, reads the journal, plans the next test
  /// and calls `answer`.
  void append(daemon::BatchEvent event, Answer answer);
  /// Applies what was appended to the journal; sets trouble_.
  void read_on();
  /// Sets the plan of the next test if the step or the batch has changed.
  void lead();
  /// Appends records of the current batch that the journal lacks; blocks.
  void reconcile();
  /// Reads the records from index `at` on and calls Parts::earlier for each. Each is a job of its own, so
  /// that appends need not wait for all.
  void tell_earlier(std::vector<std::string> records, std::size_t at);

  Parts parts_;
  daemon::BatchJournal journal_;
  daemon::BatchBook book_;
  /// Steps of tests without a published record. Key: number of the test.
  std::map<std::int64_t, daemon::BatchStep> under_way_;
  std::optional<daemon::BatchStep> planned_;  ///< The step that the plan is set to.
  std::string led_batch_;                     ///< The batch whose sample is in the plan; empty: none.
  std::string trouble_;
  boost::asio::thread_pool pool_{1};
};

}  // namespace stickslip::batch

/// \file
/// Leads through a batch: plans the next test when one has begun, writes down what was recorded, and finds
/// its place again after a restart.
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

/// Main thread, but for the pool inside, which alone writes the journal and reads records.
class BatchLeader final : public daemon::Batches {
 public:
  struct Parts {
    std::filesystem::path folder;  ///< Of the records.
    std::string program;           ///< Of place_of().
    std::function<daemon::Plan()> plan;
    std::function<void(daemon::Plan)> set_plan;
    std::function<void(daemon::TestSummary)> earlier;    ///< A test of the batch, of before this began.
    std::function<void(std::function<void()>)> on_main;  ///< From any thread: to the main thread.
    const base::Clock* clock;                            ///< Outlives this object.
  };
  explicit BatchLeader(Parts parts);
  /// As close().
  ~BatchLeader() override;
  BatchLeader(const BatchLeader&) = delete;
  BatchLeader& operator=(const BatchLeader&) = delete;

  /// Reads the journal, adds the records that a stop kept it from adding, plans the next test. The tests of
  /// the batch that goes on are told one after the other, from their records.
  void open();
  /// Behind those of the batch that goes on; 1 without one.
  [[nodiscard]] std::int64_t next_test_number() const;

  /// Waits for what is being written. Only what came before is told any more.
  void close();

  // What became of tests.
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
  /// On the pool; then the book is read on, the next test planned, and `answer` told.
  void append(daemon::BatchEvent event, Answer answer);
  /// What the journal has got; trouble with it is kept for people.
  void read_on();
  /// Plans the next test, if that is another than was planned.
  void lead();
  /// The records of the current batch that the journal lacks.
  void reconcile();
  /// Of these records from that index on; one at a time, so that nothing that is to be written waits for all.
  void tell_earlier(std::vector<std::string> records, std::size_t at);

  Parts parts_;
  daemon::BatchJournal journal_;
  daemon::BatchBook book_;
  std::map<std::int64_t, daemon::BatchStep> under_way_;  ///< By the number of the test.
  std::optional<daemon::BatchStep> planned_;             ///< What the next test will be.
  std::string led_batch_;                                ///< Whose facts are in the plan; empty: of none.
  std::string trouble_;
  boost::asio::thread_pool pool_{1};
};

}  // namespace stickslip::batch

/// \file
/// Keeps the history of the tester while the daemon runs: a line for each record, the control charts over
/// them, and their alarms.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <boost/asio/thread_pool.hpp>

#include "core/base/clock.hpp"
#include "core/base/finding.hpp"
#include "daemon/types/batch.hpp"
#include "daemon/types/batch_journal.hpp"
#include "daemon/types/tester_history.hpp"
#include "daemon/types/trend_state.hpp"

namespace stickslip::charts {

/// Thread-safe. After open(), a thread inside reads records and appends to the history.
class Keeper {
 public:
  struct Parts {
    std::filesystem::path folder;  ///< The record folder.
    std::string reference;         ///< Name of the sample that is the reference paper; empty: none.
    /// Called once for each alarm that stands, on the thread inside.
    std::function<void(const base::Finding&)> alarmed;
    /// Called on the same thread with each new trouble with the history; may be empty.
    std::function<void(const std::string&)> troubled;
    const base::Clock* clock;  ///< Outlives this object.
  };
  explicit Keeper(Parts parts) : parts_(std::move(parts)) {}
  ~Keeper() { close(); }
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  /// Most records of before the history that are added at the start: the latest.
  static constexpr std::size_t kMostAdded = 1000;

  /// Call it once, after recovery. Reads the history and adds the records that it lacks, except those older
  /// than its first; does not block.
  void open();
  /// Adds a record; does not block.
  void record_published(const std::filesystem::path& file);
  /// Blocks until all records so far are added, those of before the start among them.
  void settle();
  /// Blocks until the records published so far are added; of those of before the start the rest waits for the
  /// next one.
  void close();

  [[nodiscard]] daemon::TrendState state() const;
  /// Reads what others appended to the history and the batches, such as a restart or a voiding; does not
  /// block.
  void look();
  /// The same, and then gives the charts as daemon::trend_course_json() writes them. \param answer  called on
  /// the thread inside.
  void ask(std::function<void(std::string)> answer);

 private:
  /// Does it on the thread inside; what it throws is a trouble.
  void post(std::function<void()> work);
  // On the thread inside.
  void begin();
  void add(const std::filesystem::path& file);
  /// Reads on, applies what is new to the charts, tells new alarms and sets state_.
  void evaluate();

  Parts parts_;
  /// It forgets what charts_ has: the file may hold years.
  std::unique_ptr<daemon::TesterHistory> history_ = std::make_unique<daemon::TesterHistory>(parts_.folder);
  daemon::BatchJournal batches_{parts_.folder};
  daemon::BatchBook book_;
  trend::TesterCharts charts_;
  std::map<std::string, daemon::Voiding> voided_;  ///< Records that charts_ leaves out.
  std::set<std::string> alarmed_;                  ///< Codes of the alarms that stand and were told.
  std::string trouble_;   ///< Why the latest line could not be written; empty: it was.
  std::string left_out_;  ///< The first line that could not be read; empty: none.
  mutable std::mutex mutex_;
  daemon::TrendState state_;  ///< Guarded by mutex_.
  std::atomic<bool> closing_{false};
  std::atomic<bool> looking_{false};  ///< A look() waits for its turn.
  boost::asio::thread_pool pool_{1};
};

}  // namespace stickslip::charts

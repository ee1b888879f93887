/// \file
/// The history of a tester: a file of its own beside the records, `tester-history.jsonl`. A line for each
/// finished test, restart of a control chart, and name of the reference paper; each with a checksum. It stays
/// when records are removed.
///
///     TesterHistory history{folder};
///     history.append({test_event(record, "20261121T125252Z-0003.h5")});
///     history.read_on();
///     const trend::TesterCharts charts = history.charts(book);
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/record.hpp"
#include "core/trend/tester_charts.hpp"
#include "daemon/types/batch.hpp"
#include "daemon/types/line_journal.hpp"

namespace stickslip::daemon {

inline constexpr const char* kTesterHistory = "tester-history.jsonl";

/// A test came to its end. Only complete ones give values to charts.
struct TestFinished {
  std::string uuid;
  record::Status status = record::Status::kComplete;
  trend::TestValues values;

  bool operator==(const TestFinished&) const = default;
};

struct ChartsRestarted {
  std::optional<trend::Quantity> chart;  ///< Absent: all.
  bool baseline_stays = false;           ///< As TesterCharts::restart().
  std::string reason;
  std::string who;

  bool operator==(const ChartsRestarted&) const = default;
};

/// From now on this sample is the reference paper; empty: none is.
struct ReferenceNamed {
  std::string sample;

  bool operator==(const ReferenceNamed&) const = default;
};

struct HistoryEvent {
  std::string at;  ///< ISO 8601; of a test, when it began.
  std::variant<TestFinished, ChartsRestarted, ReferenceNamed> what;

  bool operator==(const HistoryEvent&) const = default;
};

/// What a record gives to the history: zero and noise of its self-check, omega and gamma/2omega only where no
/// characterisation of the tester was known beforehand, spikes per scan, scan rate measured over granted
/// less 1.
/// \param record  its facts suffice (read_facts()). \param name  of its file, relative to the folder.
/// Errors: kUsage if it has no end.
[[nodiscard]] base::Result<HistoryEvent> test_event(const record::Record& record, const std::string& name);

/// The event as a line of the file, without line feed.
[[nodiscard]] std::string line_of(const HistoryEvent& event);
/// Reads a line. Errors (kUsage) say what is wrong with it.
[[nodiscard]] base::Result<HistoryEvent> history_event_of(std::string_view line);

class TesterHistory {
 public:
  /// \param folder  of the records. \param calls  outlive it.
  explicit TesterHistory(const std::filesystem::path& folder,
                         const record::FileCalls& calls = record::system_calls())
      : lines_(folder / kTesterHistory, calls) {}

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return lines_.path(); }

  /// Errors: kFailure, as LineJournal::append().
  [[nodiscard]] base::Result<void> append(const std::vector<HistoryEvent>& events) const;

  /// Reads what was appended since the last call; a test counts once. \return a remark for each line that is
  /// left out: its place, and why. Errors: as LineJournal::read_on().
  [[nodiscard]] base::Result<std::vector<std::string>> read_on();

  /// In the order of the lines.
  [[nodiscard]] const std::vector<HistoryEvent>& events() const noexcept { return events_; }
  /// Drops from memory events(), and of has() and records() all but the latest kRemembered tests by name.
  void forget();
  static constexpr std::size_t kRemembered = 1000;
  [[nodiscard]] bool has(const std::string& uuid) const { return uuids_.contains(uuid); }
  /// Names of records without folder and extension, which begin with the time, and their UUIDs.
  [[nodiscard]] const std::map<std::string, std::string>& records() const noexcept { return records_; }
  [[nodiscard]] const std::string& reference() const noexcept { return reference_; }

  /// The charts of the tests that are complete and not void. \param reference  of the charts; absent: as the
  /// history names it.
  [[nodiscard]] trend::TesterCharts charts(const BatchBook& book,
                                           const std::optional<std::string>& reference = {}) const;

 private:
  LineJournal lines_;
  std::vector<HistoryEvent> events_;
  std::set<std::string, std::less<>> uuids_;
  std::map<std::string, std::string> records_;
  std::string reference_;
};

/// The charts of a history that was read, without the tests that are void now by the batches of its folder.
/// Errors: as BatchJournal::read_on(). \param reference  as of TesterHistory::charts().
[[nodiscard]] base::Result<trend::TesterCharts> charts_now(const TesterHistory& history,
                                                           const std::optional<std::string>& reference = {});

/// Applies an event to the charts. \return the quantities that it newly alarms.
std::vector<trend::Quantity> apply(const HistoryEvent& event, const BatchBook& book,
                                   trend::TesterCharts& charts);

}  // namespace stickslip::daemon

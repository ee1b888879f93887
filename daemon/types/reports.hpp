/// \file
/// Interface between the control interface and what is made of records: reports, traces, searches.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::daemon {

struct ReportedBatch {
  std::string id;     ///< Identifier in the batch journal.
  std::string label;  ///< Name shown in the report.
};

/// What may be averaged although it differs, as words of `stickslip report --pool`.
inline constexpr std::string_view kPoolings[] = {"grades", "regimes", "grades,regimes"};

/// Most bins of a trace that a client may ask for; bins if it says nothing.
inline constexpr std::size_t kMostTracePoints = 20'000;
inline constexpr std::size_t kUsualTracePoints = 2000;

/// Part of a record that is to be drawn, as report::TraceSpan.
struct TraceRequest {
  std::filesystem::path record;
  std::size_t points = kUsualTracePoints;
  std::optional<double> from_s{};
  std::optional<double> to_s{};
};

/// Most records that a search may give; records if the client says nothing.
inline constexpr std::size_t kMostFound = 1000;
inline constexpr std::size_t kUsualFound = 100;

/// A search in the record folder: the newest records that meet all conditions.
struct RecordSearch {
  /// Options of `stickslip find`, without dashes, and their values.
  std::vector<std::pair<std::string, std::string>> conditions;
  std::size_t most = kUsualFound;
};

enum class ReportForm { kPage, kCsv, kJson };

/// Main thread.
class Reports {
 public:
  virtual ~Reports() = default;
  /// Called with the text. Errors: kBusy while another one of its kind is being made, else kFailure with the
  /// reason.
  using Answer = std::function<void(base::Result<std::string>)>;

  /// Makes a report on one batch, or a comparison of two; does not block. \param batches  one or two
  /// (contract). \param pool  one of kPoolings; empty: neither grades nor regimes. \param answer  called
  /// once, on the main thread, at once or later.
  virtual void make(std::span<const ReportedBatch> batches, ReportForm form, std::string_view pool,
                    Answer answer) = 0;
  /// Reads the trace of a record, as report::binned_trace_json(); does not block, nor waits for a report.
  /// \param answer  as of make().
  virtual void trace(const TraceRequest& request, Answer answer) = 0;
  /// Makes the report on one record, as make() does.
  virtual void report(const std::filesystem::path& record, ReportForm form, Answer answer) = 0;
  /// Searches the records, as `stickslip find --json`; does not block, nor waits for a report. \param answer
  /// as of make(); also kUsage if a condition is wrong.
  virtual void find(const RecordSearch& search, Answer answer) = 0;
  /// Path of a record by its name from the record folder on, as find() gives it. Errors: kUsage if there is
  /// none.
  [[nodiscard]] virtual base::Result<std::filesystem::path> record(const std::string& name) const = 0;
};

}  // namespace stickslip::daemon

/// \file
/// Interface between the control interface and the reports on batches.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::daemon {

struct ReportedBatch {
  std::string id;     ///< Identifier in the batch journal.
  std::string label;  ///< Name shown in the report.
};

/// What may be averaged although it differs, as words of `stickslip report --pool`.
inline constexpr std::string_view kPoolings[] = {"grades", "regimes", "grades,regimes"};

enum class ReportForm { kPage, kCsv, kJson };

/// Main thread.
class Reports {
 public:
  virtual ~Reports() = default;
  /// Called with the text of the report. Errors: kBusy while another report is being made, else kFailure with
  /// the reason.
  using Answer = std::function<void(base::Result<std::string>)>;

  /// Makes a report on one batch, or a comparison of two; does not block. \param batches  one or two
  /// (contract). \param pool  one of kPoolings; empty: neither grades nor regimes. \param answer  called
  /// once, on the main thread, at once or later.
  virtual void make(std::span<const ReportedBatch> batches, ReportForm form, std::string_view pool,
                    Answer answer) = 0;
};

}  // namespace stickslip::daemon

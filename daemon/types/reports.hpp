/// \file
/// What people ask of the daemon about the tests of whole batches.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "core/base/result.hpp"

namespace stickslip::daemon {

struct ReportedBatch {
  std::string id;     ///< In the journal.
  std::string label;  ///< For people.
};

enum class ReportForm { kPage, kCsv, kJson };

/// Main thread.
class Reports {
 public:
  virtual ~Reports() = default;
  /// The text of the report. Errors: kBusy while another one is being made; else why there is none.
  using Answer = std::function<void(base::Result<std::string>)>;

  /// \param batches  one to be reported, or two to be compared (contract). \param answer  called on the main
  /// thread, once, at once or later.
  virtual void make(std::span<const ReportedBatch> batches, ReportForm form, Answer answer) = 0;
};

}  // namespace stickslip::daemon

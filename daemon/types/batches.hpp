/// \file
/// Interface between the control interface and the batches.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "daemon/types/batch.hpp"

namespace stickslip::daemon {

/// A test of the batch whose record is not published yet: it runs, or its record is being written.
struct StepUnderWay {
  std::int64_t test = 0;
  BatchStep step;
};

/// Progress of the current batch.
struct BatchProgress {
  std::string id;
  std::string name;  ///< Name of its sample.
  std::int64_t done = 0;
  std::int64_t planned = 0;
  std::optional<BatchStep> next;  ///< Absent: every step has its test.
  std::string trouble;            ///< Why the journal could not be written or read; empty: all is well.
  std::vector<StepUnderWay> under_way = {};  ///< By number of the test.
};

/// Main thread. Changes are written to the journal by another thread; none of the functions waits for it.
class Batches {
 public:
  virtual ~Batches() = default;
  /// Called once, on the main thread, when the change is in the journal or refused. Errors: kBusy if the
  /// present state forbids it, kUsage if the request is wrong, kFailure if the journal cannot be written.
  using Answer = std::function<void(const base::Result<void>&)>;

  /// All batches, after reading what was appended to the journal.
  [[nodiscard]] virtual const BatchBook& book() = 0;
  [[nodiscard]] virtual std::optional<BatchProgress> progress() const = 0;
  /// Name of a record in the journal: see name_in_journal().
  [[nodiscard]] virtual std::string name_of(const std::filesystem::path& record) const = 0;

  virtual void begin(BatchPlan plan, std::string who, Answer answer) = 0;
  virtual void end(std::string who, Answer answer) = 0;
  /// Makes a test void. \param record  its name in the journal.
  virtual void void_test(const std::string& record, std::string reason, std::string who, Answer answer) = 0;
  virtual void restore(const std::string& record, std::string who, Answer answer) = 0;
};

}  // namespace stickslip::daemon

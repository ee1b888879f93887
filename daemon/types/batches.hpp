/// \file
/// What people ask about batches through the control interface.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.hpp"
#include "daemon/types/batch.hpp"

namespace stickslip::daemon {

/// How far the current batch is.
struct BatchProgress {
  std::string id;
  std::string name;  ///< Of its sample.
  std::int64_t done = 0;
  std::int64_t planned = 0;
  std::optional<BatchStep> next;  ///< None: all are made.
  std::string trouble;            ///< Why the journal is behind; empty: it is not.
};

/// Main thread.
class Batches {
 public:
  virtual ~Batches() = default;
  /// Called on the main thread, once. Errors: kBusy where the state of things refuses, kUsage where the
  /// request is wrong, else kFailure.
  using Answer = std::function<void(const base::Result<void>&)>;

  /// As the journal has it now.
  [[nodiscard]] virtual const BatchBook& book() = 0;
  [[nodiscard]] virtual std::optional<BatchProgress> progress() const = 0;
  /// Of a record, in the journal.
  [[nodiscard]] virtual std::string name_of(const std::filesystem::path& record) const = 0;

  virtual void begin(BatchPlan plan, std::string who, Answer answer) = 0;
  virtual void end(std::string who, Answer answer) = 0;
  /// \param record  by its name in the journal.
  virtual void void_test(const std::string& record, std::string reason, std::string who, Answer answer) = 0;
  virtual void restore(const std::string& record, std::string who, Answer answer) = 0;
};

}  // namespace stickslip::daemon

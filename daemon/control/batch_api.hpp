/// \file
/// The requests about batches and void tests; api.hpp has seen to names, repetitions and who has the bench.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/batches.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::control {

/// {"batch": null}, or the current batch with its plan, tests and what comes next.
[[nodiscard]] nlohmann::ordered_json batch_json(daemon::Batches& batches);
/// The record that {"test": 7} or {"record": "…"} names: one of the latest tests, or one of a batch. Errors:
/// kUsage.
[[nodiscard]] base::Result<std::string> record_named(const nlohmann::ordered_json& body,
                                                     const daemon::Bench& bench, daemon::Batches& batches);

/// The answer of a request that changed something: the batch as it is now, or the refusal.
[[nodiscard]] daemon::Batches::Answer reply_with_batch(daemon::Batches& batches, daemon::HttpAnswer answer);

}  // namespace stickslip::control

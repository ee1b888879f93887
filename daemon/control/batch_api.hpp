/// \file
/// Parts of the requests about batches and void tests. api.cpp has checked name, Idempotency-Key and lease
/// before.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/batches.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::control {

/// {"batch": null}, or the current batch with its plan, its tests and the next step.
[[nodiscard]] nlohmann::ordered_json batch_json(daemon::Batches& batches);
/// The name, in the batch journal, of the record that {"test": 7} (one of the latest tests) or {"record":
/// "…"} (one of any batch) means. Errors: kUsage.
[[nodiscard]] base::Result<std::string> record_named(const nlohmann::ordered_json& body,
                                                     const daemon::Bench& bench, daemon::Batches& batches);

/// Makes an Answer that replies with the batch after the change, or with the refusal.
[[nodiscard]] daemon::Batches::Answer reply_with_batch(daemon::Batches& batches, daemon::HttpAnswer answer);

}  // namespace stickslip::control

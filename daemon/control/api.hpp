/// \file
/// What the control interface answers, version 1. daemon/control/openapi.json describes it and is served at
/// /v1/openapi.json.
///
/// Whoever reads needs no name. Who commands gives one in the header Stickslip-Controller and has the bench
/// for half a minute; others are refused meanwhile. A request that changes something may carry an
/// Idempotency-Key: repeated, it is answered as then, and nothing is done twice.
///
/// Every refusal is JSON too: {"error": "what is wrong and what is allowed"}.
#pragma once

#include "core/base/clock.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::control {

/// \param bench,clock  outlive the handler. \param clock  of the leases: wall time.
[[nodiscard]] daemon::HttpHandler make_api(daemon::Bench& bench, const base::Clock& clock);

}  // namespace stickslip::control

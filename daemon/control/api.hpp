/// \file
/// The control interface, version 1, as a handler of HTTP requests. daemon/control/openapi.json describes it
/// and is served at /v1/openapi.json.
///
/// Reading needs no name. A command needs one, in the header Stickslip-Controller; it reserves the bench for
/// 30 s (lease.hpp), and commands under other names are refused meanwhile. A command may carry an
/// Idempotency-Key: if it is repeated, the first reply is sent again and nothing is done twice.
///
/// A refusal is JSON: {"error": "what is wrong and what is allowed"}.
#pragma once

#include "core/base/clock.hpp"
#include "daemon/control/lease.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::control {

/// \param bench,clock,lease  outlive the handler. \param clock  measures the lease; runs at wall speed.
[[nodiscard]] daemon::HttpHandler make_api(daemon::Bench& bench, const base::Clock& clock, Lease& lease);

}  // namespace stickslip::control

/// \file
/// The request for the trace of a finished test.
#pragma once

#include <string_view>

#include "daemon/types/batch.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::control {

/// End of the path of that request, behind the test's number.
inline constexpr std::string_view kTracePath = "/trace";

/// GET /v1/tests/N/trace?points=P&from=S&to=S: 400 if the query is wrong; 409 if the test is void, has no
/// record yet or never will, or the record cannot be read; 503 while another trace is being read.
void answer_trace(const daemon::HttpRequest& request, const daemon::TestSummary& test,
                  const daemon::Voiding* voided, daemon::Reports& reports, const daemon::HttpAnswer& answer);

}  // namespace stickslip::control

/// \file
/// The requests for a trace: of a finished test by its number, of any record by its name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "daemon/types/batch.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::control {

/// End of the path of that request, behind the test's number or the record's name.
inline constexpr std::string_view kTracePath = "/trace";

/// Why what is void has no trace, and what helps. \param what  "test 7".
[[nodiscard]] std::string void_refusal(const std::string& what, const daemon::Voiding& voided);
/// Why a test has no trace; empty: it has a record. \param voided  null: it counts.
[[nodiscard]] std::string without_trace(const daemon::TestSummary& test, const daemon::Voiding* voided);

/// …/trace?points=P&from=S&to=S: 400 if the query is wrong; 409 if there is a reason against it, such as
/// without_trace(), or the record cannot be read; 503 while another trace is being read.
void answer_trace(const daemon::HttpRequest& request, const std::filesystem::path& record,
                  const std::string& why_not, daemon::Reports& reports, const daemon::HttpAnswer& answer);

}  // namespace stickslip::control

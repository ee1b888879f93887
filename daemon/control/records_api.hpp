/// \file
/// The requests for records: the search in the record folder; of one record its file, its trace, the report
/// on it.
#pragma once

#include <cstdint>
#include <string>

#include "daemon/types/bench.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::control {

/// Largest record that is served, bytes: the reply is held in memory. Larger ones must be copied from the
/// disk.
inline constexpr std::uintmax_t kLargestServed = std::uintmax_t{64} << 20U;

/// GET /v1/records?from=…&sample=…&where=S=0.3:0.4,K=:0.3&most=N: keys as options of `stickslip find`, those
/// of several values with a comma between. 400 if one is wrong; 409 if the records cannot be searched; 503
/// during another search.
void answer_search(const daemon::HttpRequest& request, daemon::Reports& reports,
                   const daemon::HttpAnswer& answer);

/// GET /v1/records/NAME, …/trace, …/report. \param rest  behind "/v1/records/". NAME is the file name of one
/// of the latest tests or a name as the search gives it; any other gets 404 and reaches no file.
void answer_record(const daemon::HttpRequest& request, const std::string& rest, daemon::Bench& bench,
                   const daemon::HttpAnswer& answer);

}  // namespace stickslip::control

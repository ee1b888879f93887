/// \file
/// The requests for all batches, for the report on one or on a record, and for the comparison of two.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "daemon/types/batch.hpp"
#include "daemon/types/http.hpp"
#include "daemon/types/reports.hpp"

namespace stickslip::control {

/// Most batches that batches_json() lists. Reports on older ones are available by identifier.
inline constexpr std::size_t kMostListed = 1000;

/// {"batches": [{"id", "name", "grade", "begun", "ended", "counted", "voided"}, …]}, the latest first.
[[nodiscard]] nlohmann::ordered_json batches_json(const daemon::BatchBook& book);

/// GET /v1/batches/ID/report?format=html|csv|json. \param rest  "ID/report"; it is only compared with the
/// journal.
void answer_report(const daemon::HttpRequest& request, const std::string& rest, const daemon::BatchBook& book,
                   daemon::Reports& reports, const daemon::HttpAnswer& answer);

/// GET /v1/records/NAME/report?format=html|csv|json.
void answer_record_report(const daemon::HttpRequest& request, const std::filesystem::path& record,
                          daemon::Reports& reports, const daemon::HttpAnswer& answer);

/// GET /v1/compare?a=ID&b=ID&format=html|csv|json.
void answer_comparison(const daemon::HttpRequest& request, const daemon::BatchBook& book,
                       daemon::Reports& reports, const daemon::HttpAnswer& answer);

}  // namespace stickslip::control

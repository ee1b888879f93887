#include "daemon/control/trace_api.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

#include "core/base/quantity.hpp"
#include "daemon/control/query.hpp"
#include "daemon/control/request_body.hpp"
#include "daemon/types/reply.hpp"

namespace stickslip::control {
namespace {

/// A time of the query, s after the first scan. Errors: kUsage.
base::Result<std::optional<double>> time_in(const Query& query, const char* key) {
  const auto asked = query.find(key);
  if (asked == query.end()) return std::nullopt;
  const base::Result<double> time_s = base::parse_number(asked->second);
  if (time_s && *time_s >= 0.0) return *time_s;
  return base::usage_error("{}: must be seconds after the first scan, 0 or more, not {}", key,
                           printable(asked->second));
}

base::Result<std::size_t> points_in(const Query& query) {
  const auto asked = query.find("points");
  if (asked == query.end()) return daemon::kUsualTracePoints;
  const base::Result<double> points = base::parse_number(asked->second);
  if (points && *points >= 1.0 && *points <= static_cast<double>(daemon::kMostTracePoints) &&
      *points == static_cast<double>(static_cast<std::size_t>(*points)))
    return static_cast<std::size_t>(*points);
  return base::usage_error("points: must be a whole number from 1 to {}, not {}", daemon::kMostTracePoints,
                           printable(asked->second));
}

base::Result<daemon::TraceRequest> trace_request(const std::string& target) {
  const auto query = query_of(target, {"points", "from", "to"});
  if (!query) return tl::unexpected(query.error());
  const auto points = points_in(*query);
  if (!points) return tl::unexpected(points.error());
  const auto from_s = time_in(*query, "from");
  if (!from_s) return tl::unexpected(from_s.error());
  const auto to_s = time_in(*query, "to");
  if (!to_s) return tl::unexpected(to_s.error());
  if (*to_s && !(**to_s > from_s->value_or(0.0)))
    return base::usage_error("to: must be above from, {} s, not {}", from_s->value_or(0.0), **to_s);
  return daemon::TraceRequest{.record = {}, .points = *points, .from_s = *from_s, .to_s = *to_s};
}

/// Why a test has no trace; empty: it has a record.
std::string without_trace(const daemon::TestSummary& test, const daemon::Voiding* voided) {
  if (voided != nullptr)
    return fmt::format("test {} is void: {}; its record stays as it is: save it, or POST /v1/restore first",
                       test.number, voided->reason);
  if (!test.file.empty()) return {};
  if (!test.file_error.empty()) return fmt::format("test {} has no record: {}", test.number, test.file_error);
  return fmt::format("the record of test {} is being written; ask again in a moment", test.number);
}

}  // namespace

void answer_trace(const daemon::HttpRequest& request, const daemon::TestSummary& test,
                  const daemon::Voiding* voided, daemon::Reports& reports, const daemon::HttpAnswer& answer) {
  base::Result<daemon::TraceRequest> asked = trace_request(request.target);
  if (!asked) return answer(daemon::refusal(400, asked.error().message));
  if (const std::string why = without_trace(test, voided); !why.empty())
    return answer(daemon::refusal(409, why));
  asked->record = test.file;
  reports.trace(*asked,
                [answer](base::Result<std::string> text) { answer(daemon::reply_with(std::move(text))); });
}

}  // namespace stickslip::control

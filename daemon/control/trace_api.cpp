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

base::Result<daemon::TraceRequest> trace_request(const std::string& target) {
  const auto query = query_of(target, {"points", "from", "to"});
  if (!query) return tl::unexpected(query.error());
  const auto points = count_in(*query, "points", daemon::kUsualTracePoints, daemon::kMostTracePoints);
  if (!points) return tl::unexpected(points.error());
  const auto from_s = time_in(*query, "from");
  if (!from_s) return tl::unexpected(from_s.error());
  const auto to_s = time_in(*query, "to");
  if (!to_s) return tl::unexpected(to_s.error());
  if (*to_s && !(**to_s > from_s->value_or(0.0)))
    return base::usage_error("to: must be above from, {} s, not {}", from_s->value_or(0.0), **to_s);
  return daemon::TraceRequest{.record = {}, .points = *points, .from_s = *from_s, .to_s = *to_s};
}

}  // namespace

std::string void_refusal(const std::string& what, const daemon::Voiding& voided) {
  return fmt::format("{} is void: {}; its record stays as it is: save it, or POST /v1/restore first", what,
                     voided.reason);
}

std::string without_trace(const daemon::TestSummary& test, const daemon::Voiding* voided) {
  if (voided != nullptr) return void_refusal(fmt::format("test {}", test.number), *voided);
  if (!test.file.empty()) return {};
  if (!test.file_error.empty()) return fmt::format("test {} has no record: {}", test.number, test.file_error);
  return fmt::format("the record of test {} is being written; ask again in a moment", test.number);
}

void answer_trace(const daemon::HttpRequest& request, const std::filesystem::path& record,
                  const std::string& why_not, daemon::Reports& reports, const daemon::HttpAnswer& answer) {
  base::Result<daemon::TraceRequest> asked = trace_request(request.target);
  if (!asked) return answer(daemon::refusal(400, asked.error().message));
  if (!why_not.empty()) return answer(daemon::refusal(409, why_not));
  asked->record = record;
  reports.trace(*asked,
                [answer](base::Result<std::string> text) { answer(daemon::reply_with(std::move(text))); });
}

}  // namespace stickslip::control

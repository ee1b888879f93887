#include "daemon/control/records_api.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>

#include "daemon/control/query.hpp"
#include "daemon/control/report_api.hpp"
#include "daemon/control/request_body.hpp"
#include "daemon/control/trace_api.hpp"
#include "daemon/types/reply.hpp"

namespace stickslip::control {
namespace {

constexpr std::string_view kReportPath = "/report";

/// The file of a record.
daemon::HttpReply file_reply(const std::filesystem::path& record) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(record, error);
  if (error) return daemon::refusal(404, fmt::format("{}: {}", record.string(), error.message()));
  if (size > kLargestServed) {
    return daemon::refusal(404, fmt::format("{} has {} MiB, more than {} are not sent: copy it from the disk",
                                            record.string(), size >> 20U, kLargestServed >> 20U));
  }
  std::ifstream file{record, std::ios::binary};
  daemon::HttpReply reply{200, std::string{std::istreambuf_iterator<char>{file}, {}}, {}};
  if (reply.body.size() != size)
    return daemon::refusal(404, fmt::format("{} cannot be read", record.string()));
  reply.content_type = "application/x-hdf5";
  return reply;
}

base::Result<std::filesystem::path> record_of(const std::string& name, const daemon::Bench& bench,
                                              const daemon::Reports& reports) {
  auto record = reports.record(name);
  for (const daemon::TestSummary& test : bench.tests()) {
    if (!record && !test.file.empty() && std::filesystem::path{test.file}.filename() == name)
      return test.file;
  }
  return record;
}

base::Result<daemon::RecordSearch> search_of(const std::string& target) {
  const auto query = query_of(target, {"from", "to", "sample", "grade", "operator", "batch", "method",
                                       "regime", "finding", "where", "fact", "most"});
  if (!query) return tl::unexpected(query.error());
  daemon::RecordSearch search;
  for (const auto& [key, value] : *query) {
    if (key == "most" || value.empty()) continue;
    std::vector<std::string> values{value};
    if (key == "regime" || key == "finding" || key == "where")
      boost::split(values, value, boost::is_any_of(","));
    for (std::string& one : values) {
      if (one.find('\0') != std::string::npos)
        return base::usage_error("{}: holds a zero byte; leave it out", key);
      if (one.empty()) return base::usage_error("{}: nothing stands between two commas; leave one out", key);
      search.conditions.emplace_back(key, std::move(one));
    }
  }
  const auto most = count_in(*query, "most", daemon::kUsualFound, daemon::kMostFound);
  if (!most) return tl::unexpected(most.error());
  search.most = *most;
  return search;
}

}  // namespace

void answer_search(const daemon::HttpRequest& request, daemon::Reports& reports,
                   const daemon::HttpAnswer& answer) {
  const auto search = search_of(request.target);
  if (!search) return answer(daemon::refusal(400, search.error().message));
  reports.find(*search,
               [answer](base::Result<std::string> text) { answer(daemon::reply_with(std::move(text))); });
}

void answer_record(const daemon::HttpRequest& request, const std::string& rest, daemon::Bench& bench,
                   const daemon::HttpAnswer& answer) {
  const bool trace = rest.ends_with(kTracePath);
  const bool report = rest.ends_with(kReportPath);
  const std::size_t suffix = trace ? kTracePath.size() : report ? kReportPath.size() : 0;
  const std::string named = rest.substr(0, rest.size() - suffix);
  const auto record = record_of(decoded(named).value_or(named), bench, bench.reports());
  if (!record) return answer(daemon::refusal(404, record.error().message));
  if (report) return answer_record_report(request, *record, bench.reports(), answer);
  if (!trace) return answer(file_reply(*record));
  daemon::Batches& batches = bench.batches();
  const daemon::Voiding* const voided = batches.book().voided(batches.name_of(*record));
  answer_trace(request, *record,
               voided == nullptr ? std::string{} : void_refusal(record->filename().string(), *voided),
               bench.reports(), answer);
}

}  // namespace stickslip::control

#include "daemon/control/report_api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/control/query.hpp"
#include "daemon/control/request_body.hpp"
#include "daemon/types/reply.hpp"

namespace stickslip::control {
namespace {

using Json = nlohmann::ordered_json;

struct Form {
  const char* name;
  daemon::ReportForm form;
  const char* content_type;
};

constexpr std::array<Form, 3> kForms{{{"html", daemon::ReportForm::kPage, "text/html; charset=utf-8"},
                                      {"csv", daemon::ReportForm::kCsv, "text/csv; charset=utf-8"},
                                      {"json", daemon::ReportForm::kJson, "application/json"}}};

base::Result<Form> form_of(const Query& query) {
  const auto asked = query.find("format");
  if (asked == query.end()) return kForms.front();
  const auto* const form = std::find_if(kForms.begin(), kForms.end(),
                                        [&asked](const Form& one) { return asked->second == one.name; });
  if (form != kForms.end()) return *form;
  return base::usage_error("format: is html, csv or json, not {}", printable(asked->second));
}

/// Empty: not given.
base::Result<std::string> pool_of(const Query& query) {
  const auto asked = query.find("pool");
  if (asked == query.end()) return std::string{};
  if (std::find(std::begin(daemon::kPoolings), std::end(daemon::kPoolings), asked->second) !=
      std::end(daemon::kPoolings))
    return asked->second;
  return base::usage_error("pool: is {}, not {}", fmt::join(daemon::kPoolings, " or "),
                           printable(asked->second));
}

const daemon::Batch* known(const daemon::BatchBook& book, const std::string& id) {
  const auto& all = book.batches();
  const auto found =
      std::find_if(all.begin(), all.end(), [&id](const daemon::Batch& one) { return one.id == id; });
  return found == all.end() ? nullptr : &*found;
}

daemon::HttpReply unknown(const std::string& id) {
  return daemon::refusal(404, fmt::format("there is no batch {}; GET /v1/batches lists them", printable(id)));
}

daemon::ReportedBatch reported(const daemon::Batch& batch) {
  return {batch.id, fmt::format("{} ({})", batch.plan.sample.name, batch.id)};
}

daemon::Reports::Answer reply_with_report(const Form& form, daemon::HttpAnswer answer) {
  return [form, answer = std::move(answer)](base::Result<std::string> text) {
    answer(daemon::reply_with(std::move(text), form.content_type));
  };
}

}  // namespace

Json batches_json(const daemon::BatchBook& book) {
  Json list = Json::array();
  const auto& all = book.batches();
  for (auto batch = all.rbegin(); batch != all.rend() && list.size() < kMostListed; ++batch) {
    const auto voided =
        std::count_if(batch->tests.begin(), batch->tests.end(),
                      [&book](const daemon::BatchTest& test) { return book.voided(test.record) != nullptr; });
    list.push_back(
        {{"id", batch->id},
         {"name", batch->plan.sample.name},
         {"grade", batch->plan.sample.grade.empty() ? Json(nullptr) : Json(batch->plan.sample.grade)},
         {"begun", batch->begun_at},
         {"ended", batch->ended_at ? Json(*batch->ended_at) : Json(nullptr)},
         {"counted", std::ssize(batch->tests) - voided},
         {"voided", voided}});
  }
  return {{"batches", std::move(list)}};
}

void answer_report(const daemon::HttpRequest& request, const std::string& rest, const daemon::BatchBook& book,
                   daemon::Reports& reports, const daemon::HttpAnswer& answer) {
  constexpr std::string_view kReport = "/report";
  if (!rest.ends_with(kReport))
    return answer(daemon::refusal(404, "there is nothing; /v1/batches/ID/report is the report on a batch"));
  const std::string id = rest.substr(0, rest.size() - kReport.size());
  const daemon::Batch* const batch = known(book, id);
  if (batch == nullptr) return answer(unknown(id));
  const auto query = query_of(request.target, {"format", "pool"});
  if (!query) return answer(daemon::refusal(400, query.error().message));
  const auto form = form_of(*query);
  if (!form) return answer(daemon::refusal(400, form.error().message));
  const auto pool = pool_of(*query);
  if (!pool) return answer(daemon::refusal(400, pool.error().message));
  reports.make(std::array{reported(*batch)}, form->form, *pool, reply_with_report(*form, answer));
}

void answer_record_report(const daemon::HttpRequest& request, const std::filesystem::path& record,
                          daemon::Reports& reports, const daemon::HttpAnswer& answer) {
  const auto query = query_of(request.target, {"format"});
  if (!query) return answer(daemon::refusal(400, query.error().message));
  const auto form = form_of(*query);
  if (!form) return answer(daemon::refusal(400, form.error().message));
  reports.report(record, form->form, reply_with_report(*form, answer));
}

void answer_comparison(const daemon::HttpRequest& request, const daemon::BatchBook& book,
                       daemon::Reports& reports, const daemon::HttpAnswer& answer) {
  const auto query = query_of(request.target, {"a", "b", "format", "pool"});
  if (!query) return answer(daemon::refusal(400, query.error().message));
  const auto form = form_of(*query);
  if (!form) return answer(daemon::refusal(400, form.error().message));
  const auto pool = pool_of(*query);
  if (!pool) return answer(daemon::refusal(400, pool.error().message));
  std::vector<daemon::ReportedBatch> two;
  for (const char* side : {"a", "b"}) {
    const auto id = query->find(side);
    if (id == query->end())
      return answer(
          daemon::refusal(400, "which two batches? /v1/compare?a=ID&b=ID; GET /v1/batches lists them"));
    const daemon::Batch* const batch = known(book, id->second);
    if (batch == nullptr) return answer(unknown(id->second));
    two.push_back(reported(*batch));
  }
  if (two[0].id == two[1].id)
    return answer(daemon::refusal(400, fmt::format("a and b are the same batch, {}", two[0].id)));
  reports.make(two, form->form, *pool, reply_with_report(*form, answer));
}

}  // namespace stickslip::control

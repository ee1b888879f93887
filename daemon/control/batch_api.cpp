#include "daemon/control/batch_api.hpp"

#include <algorithm>
#include <utility>

#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/base/wording.hpp"
#include "daemon/types/batch_json.hpp"
#include "daemon/types/reply.hpp"

namespace stickslip::control {
namespace {

using Json = nlohmann::ordered_json;

bool in_a_batch(const daemon::BatchBook& book, const std::string& record) {
  return std::any_of(book.batches().begin(), book.batches().end(),
                     [&](const daemon::Batch& batch) { return book.has(batch.id, record); });
}

}  // namespace

Json batch_json(daemon::Batches& batches) {
  const daemon::BatchBook& book = batches.book();
  const daemon::Batch* const batch = book.current();
  if (batch == nullptr) return {{"batch", nullptr}};
  Json json = daemon::progress_json(batches.progress());
  json["begun"] = batch->begun_at;
  json["by"] = batch->who;
  json["plan"] = daemon::batch_plan_json(batch->plan);
  json["tests"] = Json::array();
  for (const daemon::BatchTest& test : batch->tests) {
    Json one{{"record", test.record}};
    one.update(daemon::step_json(test.step));
    one["voided"] = daemon::voiding_json(book.voided(test.record));
    json["tests"].push_back(std::move(one));
  }
  return {{"batch", std::move(json)}};
}

base::Result<std::string> record_named(const Json& body, const daemon::Bench& bench,
                                       daemon::Batches& batches) {
  if (body.contains("test") == body.contains("record"))
    return base::usage_error("which test? Give its number as \"test\" or its file as \"record\"");
  if (body.contains("test")) {
    const Json& number = body["test"];
    for (const daemon::TestSummary& test : bench.tests()) {
      if (!number.is_number_integer() || number != test.number) continue;
      if (test.file.empty()) return base::usage_error("test: {} has no record yet", test.number);
      return batches.name_of(test.file);
    }
    return base::usage_error("test: there is no {} among the latest tests",
                             base::one_line(io::json_text(number)));
  }
  const Json& record = body["record"];
  if (!record.is_string()) return base::usage_error("record: must be text");
  const std::string name = record.get<std::string>();
  const std::vector<daemon::TestSummary> tests = bench.tests();
  const bool known = in_a_batch(batches.book(), name) ||
                     std::any_of(tests.begin(), tests.end(), [&](const daemon::TestSummary& test) {
                       return !test.file.empty() && batches.name_of(test.file) == name;
                     });
  if (known) return name;
  return base::usage_error(
      "record: {} is none of the latest tests and of no batch; `stickslip void FILE` takes any",
      base::one_line(name));
}

daemon::Batches::Answer reply_with_batch(daemon::Batches& batches, daemon::HttpAnswer answer) {
  return [&batches, answer = std::move(answer)](const base::Result<void>& done) {
    if (done) return answer(daemon::reply_of(batch_json(batches)));
    switch (done.error().kind) {
      case base::ErrorKind::kUsage:
        return answer(daemon::refusal(400, done.error().message));
      case base::ErrorKind::kBusy:
        return answer(daemon::refusal(409, done.error().message));
      default:
        return answer(daemon::refusal(507, done.error().message));
    }
  };
}

}  // namespace stickslip::control

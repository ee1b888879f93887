#include "daemon/types/record_result.hpp"

#include "io/child_process.hpp"
#include "io/pooled_json.hpp"
#include "io/record_name.hpp"
#include "io/results_json.hpp"
#include <nlohmann/json.hpp>

#include "core/base/wording.hpp"

namespace stickslip::daemon {

using Json = nlohmann::ordered_json;

base::Result<Json> result_of(const std::string& program, const std::filesystem::path& file) {
  const auto answer = io::ask_program(program, {"--result", file.string()}, {});
  if (!answer) return tl::unexpected(answer.error());
  if (!*answer || (*answer)->status != 0) {
    return base::failure("{}: cannot be read: {}", file.string(),
                         *answer ? base::one_line((*answer)->errors, 300) : "no such program");
  }
  Json json = Json::parse((*answer)->output, nullptr, false);
  if (!json.is_object()) return base::failure("{}: its result is no JSON", file.string());
  return json;
}

base::Result<TestSummary> earlier_test(const std::string& program, const std::filesystem::path& file) {
  const base::Result<Json> json = result_of(program, file);
  if (!json) return tl::unexpected(json.error());
  TestSummary summary;
  summary.earlier = true;
  summary.file = file.string();
  try {
    const Json& number = json->at("number");
    summary.number =
        number.is_null() ? io::test_number_in(summary.file).value_or(0) : number.get<std::int64_t>();
    // An interrupted test ended by no cause of its own.
    summary.cause = pipeline::end_cause_from_name(json->at("cause").get<std::string>())
                        .value_or(pipeline::EndCause::kStopped);
    summary.results = io::results_from_json(json->at("results"));
    summary.slips = io::slip_sums_from_json(json->at("slips"));
  } catch (const Json::exception& error) {
    return base::failure("{}: its result is not understood: {}", summary.file, error.what());
  }
  return summary;
}

}  // namespace stickslip::daemon

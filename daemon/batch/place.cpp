#include "daemon/batch/place.hpp"

#include <nlohmann/json.hpp>

#include "daemon/record_result.hpp"

namespace stickslip::daemon {

base::Result<std::optional<TestRecorded>> place_of(const std::string& program,
                                                   const std::filesystem::path& file,
                                                   const std::string& name) {
  using Json = nlohmann::ordered_json;
  const base::Result<Json> told = result_of(program, file);
  if (!told) return tl::unexpected(told.error());
  const Json& json = *told;
  const Json batch = json.value("batch", Json());
  if (!batch.is_string()) return std::optional<TestRecorded>{};
  const Json plan = json.value("plan", Json::object());
  const auto number = [](const Json& from, const char* key) {
    const Json value = from.value(key, Json());
    return value.is_number_integer() ? value.get<std::int64_t>() : 1;
  };
  BatchStep step{std::nullopt, number(plan, "replicate"), number(json, "slide")};
  if (const Json speed = plan.value("pull_speed", Json()); speed.is_number())
    step.pull_speed_m_per_s = speed.get<double>();
  return TestRecorded{batch.get<std::string>(), {name, step}};
}

}  // namespace stickslip::daemon

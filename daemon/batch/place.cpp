#include "daemon/batch/place.hpp"

#include <nlohmann/json.hpp>

#include "daemon/types/record_result.hpp"

namespace stickslip::batch {

base::Result<std::optional<daemon::TestRecorded>> place_of(const std::string& program,
                                                           const std::filesystem::path& file,
                                                           const std::string& name) {
  using Json = nlohmann::ordered_json;
  const base::Result<Json> told = daemon::result_of(program, file);
  if (!told) return tl::unexpected(told.error());
  const Json& json = *told;
  const Json batch = json.value("batch", Json());
  if (!batch.is_string()) return std::optional<daemon::TestRecorded>{};
  const Json plan = json.value("plan", Json::object());
  const auto number = [](const Json& from, const char* key) {
    const Json value = from.value(key, Json());
    return value.is_number_integer() ? value.get<std::int64_t>() : 1;
  };
  daemon::BatchStep step{std::nullopt, number(plan, "replicate"), number(json, "slide")};
  if (const Json speed = plan.value("pull_speed", Json()); speed.is_number())
    step.pull_speed_m_per_s = speed.get<double>();
  return daemon::TestRecorded{batch.get<std::string>(), {name, step}};
}

}  // namespace stickslip::batch

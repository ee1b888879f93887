#include "daemon/batch/place.hpp"

#include <nlohmann/json.hpp>

#include "core/base/wording.hpp"
#include "daemon/child_process.hpp"

namespace stickslip::daemon {

base::Result<std::optional<TestRecorded>> place_of(const std::string& program,
                                                   const std::filesystem::path& file,
                                                   const std::string& name) {
  using Json = nlohmann::json;
  const auto answer = ask_program(program, {"--result", file.string()}, {});
  if (!answer) return tl::unexpected(answer.error());
  if (!*answer || (*answer)->status != 0) {
    return base::failure("{}: its place in a batch cannot be read: {}", file.string(),
                         *answer ? base::one_line((*answer)->errors, 300) : "no such program");
  }
  const Json json = Json::parse((*answer)->output, nullptr, false);
  const Json batch = json.is_object() ? json.value("batch", Json()) : Json();
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

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/friction/method_file.hpp"
#include "daemon/cli/commands.hpp"
#include "daemon/json_text.hpp"
#include "daemon/library.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json json_of(const std::optional<friction::Nominal>& nominal) {
  if (!nominal) return nullptr;
  return {{"value", nominal->value}, {"tolerance", json_of(nominal->tolerance)}};
}

/// Points of time and speed.
Json json_of(const std::optional<friction::PullSpeed>& course) {
  if (!course) return nullptr;
  Json points = Json::array();
  for (const friction::SpeedPoint& point : course->points())
    points.push_back(Json::array({point.at_s, point.speed_m_per_s}));
  return points;
}

/// SI units; null where the method leaves it open.
Json json_of(const friction::MethodFile& file) {
  const friction::Method& method = file.method;
  Json json{{"name", method.name}, {"description", file.description}, {"static_slip", method.static_slip}};
  json["kinetic_cycles"] = method.kinetic_travel ? Json(nullptr) : Json(method.kinetic_cycles);
  json["kinetic_travel"] = method.kinetic_travel
                               ? Json::array({method.kinetic_travel->from_m, method.kinetic_travel->to_m})
                               : Json(nullptr);
  json["sled_mass"] = json_of(method.sled_mass_kg);
  json["sled_area"] = json_of(method.sled_area_m2);
  json["speed"] = json_of(method.pull_speed_m_per_s);
  json["speed_course"] = json_of(method.speed_course);
  json["replicates"] = method.replicates ? Json(*method.replicates) : Json(nullptr);
  json["check"] = file.check;
  return json;
}

}  // namespace

base::Result<std::string> run_methods(const std::string& folder, bool json) {
  const base::Result<std::filesystem::path> found = library_folder(kMethods, folder);
  if (!found) return tl::unexpected(found.error());
  std::vector<friction::MethodFile> methods;
  std::size_t longest = 0;
  for (const std::filesystem::path& path : files_in(*found)) {
    const base::Result<friction::MethodFile> file = friction::load_method(path);
    if (!file) return tl::unexpected(file.error());
    longest = std::max(longest, file->method.name.size());
    methods.push_back(*file);
  }
  if (json) {
    Json list = Json::array();
    for (const friction::MethodFile& file : methods) list.push_back(json_of(file));
    return json_document(Json{{"folder", found->string()}, {"methods", std::move(list)}});
  }
  std::string text;
  for (const friction::MethodFile& file : methods) {
    text += fmt::format("{:<{}}  {}\n", file.method.name, longest, file.description);
  }
  return text;
}

}  // namespace stickslip::daemon

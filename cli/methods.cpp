#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/library.hpp"
#include "io/method_file.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

struct MethodsOptions {
  std::string folder;  ///< Empty: where the program finds them.
  bool json = false;
};

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json json_of(const std::optional<model::Nominal>& nominal) {
  if (!nominal) return nullptr;
  return {{"value", nominal->value}, {"tolerance", json_of(nominal->tolerance)}};
}

/// Points of time and speed.
Json json_of(const std::optional<model::PullSpeed>& course) {
  if (!course) return nullptr;
  Json points = Json::array();
  for (const model::SpeedPoint& point : course->points())
    points.push_back(Json::array({point.at_s, point.speed_m_per_s}));
  return points;
}

/// SI units; null where the method leaves it open.
Json json_of(const io::MethodFile& file) {
  const model::Method& method = file.method;
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

base::Result<std::string> run_methods(const MethodsOptions& options) {
  const base::Result<std::filesystem::path> found = io::library_folder(io::kMethods, options.folder);
  if (!found) return tl::unexpected(found.error());
  Json methods = Json::array();
  io::Table list = io::Table::list({0, 0});
  for (const std::filesystem::path& path : io::files_in(*found)) {
    const base::Result<io::MethodFile> file = io::load_method(path);
    if (!file) return tl::unexpected(file.error());
    methods.push_back(json_of(*file));
    list.add({file->method.name, file->description});
  }
  if (!options.json) return list.text();
  return io::json_document({{"folder", found->string()}, {"methods", methods}});
}

constexpr const char* kMethodsExamples =
    R"(Examples:
  stickslip methods
  stickslip methods --json                                     all settings, and what a laboratory checks
  stickslip methods --folder my-methods)";

}  // namespace

void add_methods(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<MethodsOptions>();
  CLI::App* command = app.add_subcommand("methods", "list the shipped test methods");
  command->footer(kMethodsExamples);
  command->add_option("--folder", options->folder, "another folder of methods")->type_name("DIR");
  command->add_flag("--json", options->json, "JSON instead of lines, with all settings and what to check");
  choose(*command, chosen, [options] { return run_methods(*options); });
}

}  // namespace stickslip::cli

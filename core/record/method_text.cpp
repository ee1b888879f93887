#include "core/record/method_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/base/quantity.hpp"
#include "core/base/wording.hpp"
#include "core/detect/live_cycle.hpp"

namespace stickslip::record {
namespace {

std::string nominal_text(const model::Nominal& nominal) {
  return nominal.tolerance ? fmt::format("{}~{}", nominal.value, *nominal.tolerance)
                           : fmt::format("{}", nominal.value);
}

bool read_count(std::string_view text, int& count) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, count);
  return error == std::errc{} && stop == end && count >= 1;
}

bool read_number(std::string_view text, double& number) {
  const base::Result<double> parsed = base::parse_number(text);
  if (parsed) number = *parsed;
  return parsed && number >= 0.0;
}

bool read_nominal(std::string_view text, std::optional<model::Nominal>& nominal) {
  const std::size_t split = text.find('~');
  nominal.emplace();
  if (split != std::string_view::npos && !read_number(text.substr(split + 1), nominal->tolerance.emplace())) {
    return false;
  }
  return read_number(text.substr(0, split), nominal->value);
}

bool read_travel(std::string_view text, std::optional<model::TravelWindow>& window) {
  const std::size_t split = text.find(':');
  window.emplace();
  return split != std::string_view::npos && read_number(text.substr(0, split), window->from_m) &&
         read_number(text.substr(split + 1), window->to_m) && window->from_m < window->to_m;
}

/// Points stand side by side with spaces; the settings of a method do, too.
constexpr char kBetweenPoints = ',';

bool read_course(std::string_view text, std::optional<model::PullSpeed>& course) {
  std::string points{text};
  std::replace(points.begin(), points.end(), kBetweenPoints, ' ');
  course = model::PullSpeed::parse(points);
  return course.has_value();
}

bool read_setting(std::string_view key, std::string_view value, model::Method& method) {
  if (key == "static_slip") return read_count(value, method.static_slip);
  if (key == "kinetic_cycles") return read_count(value, method.kinetic_cycles);
  if (key == "kinetic_travel") return read_travel(value, method.kinetic_travel);
  if (key == "sled_mass") return read_nominal(value, method.sled_mass_kg);
  if (key == "sled_area") return read_number(value, method.sled_area_m2.emplace());
  if (key == "speed") return read_nominal(value, method.pull_speed_m_per_s);
  if (key == "speed_course") return read_course(value, method.speed_course);
  if (key == "replicates") return read_count(value, method.replicates.emplace());
  // No part of the method: version 0.1 wrote it there, and read_estimator_of_0_1() reads it.
  if (key == "estimator") return detect::estimator_tier_from_name(value).has_value();
  return false;
}

}  // namespace

std::string method_text(const model::Method& method) {
  std::string text = method.name;
  if (method.static_slip != 1) text += fmt::format(" static_slip={}", method.static_slip);
  if (method.kinetic_travel) {
    text += fmt::format(" kinetic_travel={}:{}", method.kinetic_travel->from_m, method.kinetic_travel->to_m);
  } else {
    text += fmt::format(" kinetic_cycles={}", method.kinetic_cycles);
  }
  if (method.sled_mass_kg) text += " sled_mass=" + nominal_text(*method.sled_mass_kg);
  if (method.sled_area_m2) text += fmt::format(" sled_area={}", *method.sled_area_m2);
  if (method.pull_speed_m_per_s) text += " speed=" + nominal_text(*method.pull_speed_m_per_s);
  if (method.speed_course) {
    std::string points = method.speed_course->text();
    std::replace(points.begin(), points.end(), ' ', kBetweenPoints);
    text += " speed_course=" + points;
  }
  if (method.replicates) text += fmt::format(" replicates={}", *method.replicates);
  return text;
}

base::Result<model::Method> method_from_text(std::string_view text) {
  model::Method method;
  if (text.empty()) return method;
  std::size_t at = text.find(' ');
  method.name = text.substr(0, at);
  bool has_rule = false;
  bool good = !method.name.empty();
  while (good && at != std::string_view::npos) {
    const std::size_t end = text.find(' ', at + 1);
    const std::string_view setting = text.substr(at + 1, end == std::string_view::npos ? end : end - at - 1);
    const std::size_t equals = setting.find('=');
    good = equals != std::string_view::npos &&
           read_setting(setting.substr(0, equals), setting.substr(equals + 1), method);
    has_rule = has_rule || setting.starts_with("kinetic_");
    at = end;
  }
  if (!good || !has_rule) {
    return base::usage_error(
        "method \"{}\" is not of the form \"NAME kinetic_cycles=N\" with N from 1, or \"NAME "
        "kinetic_travel=FROM:TO\" in m, and known settings",
        base::one_line(text, 200));
  }
  return method;
}

}  // namespace stickslip::record

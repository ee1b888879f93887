#include "io/method_file.hpp"

#include <algorithm>
#include <optional>

#include "core/model/largest_settings.hpp"

namespace stickslip::io {
namespace {

using base::Dimension;
using base::Limits;
using base::Settings;

// Bounds that catch mistyped values, far beyond any tester.
constexpr double kLargestSled_m2 = 1.0;
constexpr double kLongestTravel_m = 10.0;
constexpr double kLongestRamp_s = 1e5;
constexpr int kMostReplicates = 1000;

std::optional<model::Nominal> nominal(Settings& table, const std::string& key, Dimension dimension,
                                      double largest) {
  const std::optional<double> value =
      table.quantity_if_given(key, dimension, Limits::above_up_to(0.0, largest));
  const std::string tolerance_key = key + "_tolerance";
  const std::optional<double> tolerance =
      table.quantity_if_given(tolerance_key, dimension, Limits::between(0.0, largest));
  if (value) return model::Nominal{*value, tolerance};
  if (tolerance) table.refuse(tolerance_key, "needs " + key);
  return std::nullopt;
}

void read_kinetic(Settings kinetic, model::Method& method) {
  const bool travel = kinetic.has("travel_from") || kinetic.has("travel_to");
  const Limits length = Limits::between(0.0, kLongestTravel_m);
  const std::optional<double> from = kinetic.quantity_if_given("travel_from", Dimension::kLength, length);
  const std::optional<double> to = kinetic.quantity_if_given("travel_to", Dimension::kLength, length);
  method.kinetic_cycles =
      static_cast<int>(kinetic.integer("cycles", 1, kMostKineticCycles, method.kinetic_cycles));
  if (!travel) return;
  if (kinetic.has("cycles")) kinetic.refuse("cycles", "must not stand beside a travel window");
  if (!kinetic.has("travel_to"))
    kinetic.refuse("travel_to", "is missing: a window has an end, such as \"60 mm\"");
  const model::TravelWindow window{from.value_or(0.0), to.value_or(0.0)};
  if (to && !(window.from_m < window.to_m)) {
    kinetic.refuse("travel_to", fmt::format("must be above travel_from = {} m", window.from_m));
  }
  method.kinetic_travel = window;
}

void read_speed(Settings& test, model::Method& method) {
  const Limits duration = Limits::above_up_to(0.0, kLongestRamp_s);
  const Limits speed = Limits::between(0.0, model::kFastestPull_m_per_s);
  method.pull_speed_m_per_s = nominal(test, "speed", Dimension::kSpeed, model::kFastestPull_m_per_s);
  const std::optional<double> to = test.quantity_if_given("speed_to", Dimension::kSpeed, speed);
  const std::optional<double> in = test.quantity_if_given("speed_ramp", Dimension::kTime, duration);
  if (to.has_value() != in.has_value()) {
    const std::string given = to ? "speed_to" : "speed_ramp";
    test.refuse(given,
                to ? "needs speed_ramp, the time to get there" : "needs speed_to, the speed at its end");
  } else if (to && !method.pull_speed_m_per_s) {
    test.refuse("speed_to", "needs speed, with which the ramp begins");
  } else if (to && method.pull_speed_m_per_s->tolerance) {
    test.refuse("speed_tolerance", "must not stand beside a ramp");
  } else if (to) {
    method.speed_course = model::PullSpeed::make({{0.0, method.pull_speed_m_per_s->value}, {*in, *to}});
    method.pull_speed_m_per_s.reset();
  }
}

base::Result<MethodFile> read(Settings settings) {
  MethodFile file;
  file.method.name = settings.text("name");
  if (settings.has("name") && !is_method_name(file.method.name)) {
    settings.refuse("name", "must be of lower case letters, digits and hyphens");
  }
  file.description = settings.text("description");
  file.check = settings.texts("check", std::vector<std::string>{});
  file.method.static_slip =
      static_cast<int>(settings.table("static").integer("slip", 1, kLastStaticSlip, file.method.static_slip));
  read_kinetic(settings.table("kinetic"), file.method);
  Settings sled = settings.table("sled");
  file.method.sled_mass_kg = nominal(sled, "mass", Dimension::kMass, model::kHeaviestSled_kg);
  file.method.sled_area_m2 =
      sled.quantity_if_given("area", Dimension::kArea, Limits::above_up_to(0.0, kLargestSled_m2));
  Settings test = settings.table("test");
  read_speed(test, file.method);
  if (test.has("replicates")) {
    file.method.replicates = static_cast<int>(test.integer("replicates", 1, kMostReplicates));
  } else {
    static_cast<void>(test.integer("replicates", 1, kMostReplicates, 1));  // So that the key is known.
  }
  if (base::Result<void> finished = settings.finish(); !finished) return tl::unexpected(finished.error());
  return file;
}

}  // namespace

base::Result<MethodFile> load_method(const std::filesystem::path& file) {
  const base::Result<Settings> settings = Settings::load(file);
  if (!settings) return tl::unexpected(settings.error());
  return read(*settings);
}

base::Result<MethodFile> parse_method(std::string_view text, std::string_view name) {
  const base::Result<Settings> settings = Settings::parse(text, name);
  if (!settings) return tl::unexpected(settings.error());
  return read(*settings);
}

bool is_method_name(std::string_view text) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  return !text.empty() && std::all_of(text.begin(), text.end(), allowed);
}

}  // namespace stickslip::io

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "core/base/settings.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {
namespace {

using base::Dimension;
using base::Limits;
using base::Settings;

// Limits of sense, not of the method: a value outside is taken for a slip of the pen.
constexpr double kLongestPhase_s = 1e8;
constexpr double kLargestCoefficient = 10.0;
constexpr double kFastestBelt_m_per_s = 10.0;
constexpr double kStrongestGravity_m_per_s2 = 100.0;
constexpr double kHeaviestSled_kg = 1000.0;
constexpr double kFastestOscillator_Hz = 1e5;
constexpr double kFastestScan_Hz = 1e6;
constexpr double kHighestVoltage_V = 1000.0;
constexpr double kLargestScatter = 0.6;   // Real paper scatters by 22–55 %.
constexpr double kFinestPaper_m = 1e-6;   // Below the thickness of a fibre,
constexpr double kCoarsestPaper_m = 1.0;  // above the length of a sheet.

constexpr std::array<std::string_view, 9> kEffects{"damping",          "constant_speed", "one_way_coupling",
                                                   "scatter",          "first_peak",     "contact_ageing",
                                                   "onset_convention", "white_noise",    "quantisation"};

void read_tester(Settings tester, double gamma_over_2omega, Scene& scene) {
  scene.sled_mass_kg =
      tester.quantity("sled_mass", Dimension::kMass, Limits::above_up_to(0.0, kHeaviestSled_kg));
  scene.gravity_m_per_s2 = tester.quantity("gravity", Dimension::kAcceleration,
                                           Limits::above_up_to(0.0, kStrongestGravity_m_per_s2),
                                           friction::kStandardGravity_m_per_s2);
  const auto frequency_Hz = tester.quantity_if_given("frequency", Dimension::kFrequency,
                                                     Limits::above_up_to(0.0, kFastestOscillator_Hz));
  const auto stiffness = tester.quantity_if_given("stiffness", Dimension::kStiffness, Limits::above(0.0));
  if (frequency_Hz && stiffness) {
    tester.refuse("stiffness", "must not stand beside frequency: one follows from the other");
  } else if (frequency_Hz) {
    scene.oscillator =
        friction::Oscillator::from_omega(2.0 * std::numbers::pi * *frequency_Hz, gamma_over_2omega);
  } else if (stiffness && scene.sled_mass_kg > 0.0) {
    // ω = ω₀ cos φ [7], [10].
    const double omega0 = std::sqrt(*stiffness / scene.sled_mass_kg);
    scene.oscillator =
        friction::Oscillator::from_omega(omega0 / std::hypot(1.0, gamma_over_2omega), gamma_over_2omega);
  } else if (!tester.has("frequency") && !tester.has("stiffness")) {
    tester.refuse("frequency", "must be given, or else stiffness");
  }
  scene.load_cell.gain_N_per_V =
      tester.quantity("load_cell_gain", Dimension::kForcePerVoltage, Limits::above(0.0));
  scene.load_cell.zero_V = tester.quantity("load_cell_zero", Dimension::kVoltage,
                                           Limits::between(-kHighestVoltage_V, kHighestVoltage_V), 0.0);
}

void read_paper(Settings paper, Scene& scene) {
  const Limits coefficient = Limits::between(0.0, kLargestCoefficient);
  scene.mu_s = paper.quantity("mu_s", Dimension::kDimensionless, coefficient);
  scene.mu_k = paper.quantity("mu_k", Dimension::kDimensionless, coefficient);
  if (scene.mu_s < scene.mu_k) {
    paper.refuse("mu_s", fmt::format("must not be below mu_k = {}", scene.mu_k));
  }
}

ConstantSpeed read_constant_speed(Settings effect) {
  const Limits duration = Limits::between(0.0, kLongestPhase_s);
  const Limits speed = Limits::above_up_to(0.0, kFastestBelt_m_per_s);
  ConstantSpeed test;
  test.idle_s = effect.quantity("idle", Dimension::kTime, duration);
  test.pull_speed_m_per_s = effect.quantity("pull_speed", Dimension::kSpeed, speed);
  test.pull_s = effect.quantity("pull", Dimension::kTime, Limits::above_up_to(0.0, kLongestPhase_s));
  test.stop_s = effect.quantity("stop", Dimension::kTime, duration);
  test.return_speed_m_per_s = effect.quantity("return_speed", Dimension::kSpeed, speed);
  test.return_s = effect.quantity("return", Dimension::kTime, duration);
  test.rest_s = effect.quantity("rest", Dimension::kTime, duration);
  return test;
}

Scatter read_scatter(Settings effect) {
  Scatter scatter;
  scatter.delta_mu_cv =
      effect.quantity("delta_mu_cv", Dimension::kDimensionless, Limits::between(0.0, kLargestScatter));
  scatter.mu_k_sd =
      effect.quantity("mu_k_sd", Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient), 0.0);
  scatter.correlation_length_m = effect.quantity("correlation_length", Dimension::kLength,
                                                 Limits::between(kFinestPaper_m, kCoarsestPaper_m), 0.001);
  return scatter;
}

FirstPeak read_first_peak(Settings effect) {
  FirstPeak peak;
  peak.change = effect.quantity("change", Dimension::kDimensionless,
                                Limits::between(-kLargestCoefficient, kLargestCoefficient));
  peak.sd = effect.quantity("sd", Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient), 0.0);
  return peak;
}

ContactAgeing read_contact_ageing(Settings effect) {
  ContactAgeing ageing;
  ageing.per_decade = effect.quantity("per_decade", Dimension::kDimensionless, Limits::between(0.0, 1.0));
  ageing.cutoff_s =
      effect.quantity("cutoff", Dimension::kTime, Limits::between(1e-9, kLongestPhase_s), 0.001);
  return ageing;
}

OnsetConvention read_onset_convention(Settings effect) {
  constexpr std::array<std::pair<std::string_view, OnsetConvention>, 2> kNames{
      {{"spring", OnsetConvention::kSpring}, {"spring-and-damper", OnsetConvention::kSpringAndDamper}}};
  return effect.choice<OnsetConvention>("force", kNames);
}

WhiteNoise read_white_noise(Settings effect, const Scene& scene) {
  const auto coefficient =
      effect.quantity_if_given("sd", Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient));
  const auto force_N = effect.quantity_if_given("sd_force", Dimension::kForce, Limits::at_least(0.0));
  const auto voltage_V =
      effect.quantity_if_given("sd_voltage", Dimension::kVoltage, Limits::between(0.0, kHighestVoltage_V));
  const int given = static_cast<int>(effect.has("sd")) + static_cast<int>(effect.has("sd_force")) +
                    static_cast<int>(effect.has("sd_voltage"));
  if (given == 0) effect.refuse("sd", "must be given, or else sd_force or sd_voltage");
  if (given > 1) {
    effect.refuse(effect.has("sd_voltage") ? "sd_voltage" : "sd_force",
                  "must not stand beside another sd: the noise has one");
  }
  const double newtons = force_N.value_or(coefficient.value_or(0.0) * scene.normal_load_N());
  return {voltage_V.value_or(newtons / scene.load_cell.gain_N_per_V)};
}

Quantisation read_quantisation(Settings effect) {
  const Limits voltage = Limits::between(-kHighestVoltage_V, kHighestVoltage_V);
  Quantisation converter;
  converter.bits = static_cast<int>(effect.integer("bits", 1, 32));
  converter.range_min_V = effect.quantity("range_min", Dimension::kVoltage, voltage);
  converter.range_max_V = effect.quantity("range_max", Dimension::kVoltage, voltage);
  if (converter.range_max_V <= converter.range_min_V) {
    effect.refuse("range_max", fmt::format("must be above range_min = {} V", converter.range_min_V));
  }
  return converter;
}

base::Result<Scene> read_scene(Settings settings, const std::filesystem::path& file) {
  Scene scene;
  scene.name = file.stem().string();
  scene.text = settings.source_text();
  scene.description = settings.text("description");
  constexpr std::int64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();
  scene.seed = static_cast<std::uint64_t>(settings.integer("seed", 0, kLargestSeed, 1));
  scene.scan_rate_Hz =
      settings.quantity("scan_rate", Dimension::kFrequency, Limits::above_up_to(0.0, kFastestScan_Hz), 350.0);

  Settings effects = settings.table("effects");
  // All are made known, so that the message about an unknown one lists them all.
  for (const std::string_view effect : kEffects) (void)effects.table(effect);
  double gamma_over_2omega = 0.0;
  if (effects.has("damping")) {
    scene.damping = true;
    gamma_over_2omega = effects.table("damping").quantity("gamma_over_2omega", Dimension::kDimensionless,
                                                          Limits::above_up_to(0.0, 100.0));
  }
  read_tester(settings.table("tester"), gamma_over_2omega, scene);
  read_paper(settings.table("paper"), scene);
  if (effects.has("constant_speed")) {
    scene.constant_speed = read_constant_speed(effects.table("constant_speed"));
    scene.duration_s = scene.constant_speed->duration_s();
  } else {
    scene.duration_s =
        settings.quantity("duration", Dimension::kTime, Limits::above_up_to(0.0, kLongestPhase_s));
  }
  scene.one_way_coupling = effects.has("one_way_coupling");
  if (effects.has("scatter")) scene.paper.scatter = read_scatter(effects.table("scatter"));
  if (effects.has("first_peak")) scene.paper.first_peak = read_first_peak(effects.table("first_peak"));
  if (effects.has("contact_ageing")) {
    scene.paper.contact_ageing = read_contact_ageing(effects.table("contact_ageing"));
  }
  if (effects.has("onset_convention")) {
    scene.onset_convention = read_onset_convention(effects.table("onset_convention"));
  }
  if (effects.has("white_noise")) {
    scene.white_noise = read_white_noise(effects.table("white_noise"), scene);
  }
  if (effects.has("quantisation")) scene.quantisation = read_quantisation(effects.table("quantisation"));

  if (auto read = settings.finish(); !read) return tl::unexpected(read.error());
  return scene;
}

}  // namespace

base::Result<Scene> load_scene(const std::filesystem::path& file) {
  base::Result<Settings> settings = Settings::load(file);
  if (!settings) return tl::unexpected(settings.error());
  return read_scene(*settings, file);
}

base::Result<Scene> parse_scene(std::string_view text, const std::filesystem::path& file) {
  base::Result<Settings> settings = Settings::parse(text, file.string());
  if (!settings) return tl::unexpected(settings.error());
  return read_scene(*settings, file);
}

}  // namespace stickslip::sim

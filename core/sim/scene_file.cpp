#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/settings.hpp"
#include "core/base/wording.hpp"
#include "core/model/largest_settings.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_file_parts.hpp"

namespace stickslip::sim {
namespace {

using base::Dimension;
using base::Limits;
using base::Settings;

// Limits of sense, not of the method: a value outside is taken for a slip of the pen.
constexpr double kStrongestGravity_m_per_s2 = 100.0;
constexpr double kFastestOscillator_Hz = 1e5;
constexpr double kFastestScan_Hz = 1e6;
constexpr double kFinestAccuracy = 1e-12;  // Beyond, a numeric solver works at the roundings of a double.
constexpr double kCoarsestAccuracy = 1e-2;

constexpr std::array<std::string_view, 2> kEffects{"damping", "one_way_coupling"};

void read_tester(Settings tester, double gamma_over_2omega, Scene& scene) {
  scene.sled_mass_kg =
      tester.quantity("sled_mass", Dimension::kMass, Limits::above_up_to(0.0, model::kHeaviestSled_kg));
  scene.gravity_m_per_s2 =
      tester.quantity("gravity", Dimension::kAcceleration,
                      Limits::above_up_to(0.0, kStrongestGravity_m_per_s2), model::kStandardGravity_m_per_s2);
  const auto frequency_Hz = tester.quantity_if_given("frequency", Dimension::kFrequency,
                                                     Limits::above_up_to(0.0, kFastestOscillator_Hz));
  const auto stiffness = tester.quantity_if_given("stiffness", Dimension::kStiffness, Limits::above(0.0));
  if (frequency_Hz && stiffness) {
    tester.refuse("stiffness", "must not stand beside frequency: one follows from the other");
  } else if (frequency_Hz) {
    scene.oscillator =
        model::Oscillator::from_omega(2.0 * std::numbers::pi * *frequency_Hz, gamma_over_2omega);
  } else if (stiffness && scene.sled_mass_kg > 0.0) {
    // ω = ω₀ cos φ [7], [10].
    const double omega0 = std::sqrt(*stiffness / scene.sled_mass_kg);
    scene.oscillator =
        model::Oscillator::from_omega(omega0 / std::hypot(1.0, gamma_over_2omega), gamma_over_2omega);
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

base::Result<Scene> read_scene(Settings settings, const std::filesystem::path& file) {
  Scene scene;
  scene.name = file.stem().string();
  scene.text = settings.source_text();
  scene.description = settings.text("description");
  constexpr std::int64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();
  scene.seed = static_cast<std::uint64_t>(settings.integer("seed", 0, kLargestSeed, 1));
  scene.scan_rate_Hz =
      settings.quantity("scan_rate", Dimension::kFrequency, Limits::above_up_to(0.0, kFastestScan_Hz), 350.0);
  scene.accuracy = settings.quantity("accuracy", Dimension::kDimensionless,
                                     Limits::between(kFinestAccuracy, kCoarsestAccuracy), scene.accuracy);

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
  scene.one_way_coupling = effects.has("one_way_coupling");
  read_belt_effects(settings, effects, scene);
  read_kinetic_drift(effects, scene);
  read_paper_effects(effects, scene);
  read_friction_laws(effects, scene);
  read_transducer_effects(effects, scene);
  read_sampling_effects(effects, scene);
  read_signal_effects(effects, scene);

  if (auto read = settings.finish(); !read) return tl::unexpected(read.error());
  return scene;
}

base::Result<Settings> changed_settings(const std::filesystem::path& file,
                                        const std::vector<SceneChange>& changes) {
  base::Result<Settings> settings = Settings::load(file);
  if (!settings) return settings;
  for (const SceneChange& change : changes) {
    const base::Result<void> done = change.value ? settings->set(change.path, *change.value, change.origin)
                                                 : settings->remove(change.path, change.origin);
    if (!done) return tl::unexpected(done.error());
  }
  return settings;
}

}  // namespace

base::Result<Scene> load_scene(const std::filesystem::path& file, const SceneChanges& changes) {
  base::Result<Settings> settings = changed_settings(file, changes.changes);
  if (!settings) return tl::unexpected(settings.error());
  if (!changes.duration) return read_scene(*settings, file);

  const SceneDuration& duration = *changes.duration;
  SceneChange change{"duration", fmt::format("{} s", duration.seconds), duration.origin};
  if (settings->table("effects").has("constant_speed")) {
    base::Result<Scene> scene = read_scene(*settings, file);
    if (!scene) return scene;
    const double others_s = scene->duration_s - scene->constant_speed->pull_s;
    const double pull_s = duration.seconds - others_s;
    if (!(pull_s > 0.0)) {
      return base::usage_error("{}: must be above {} s, which the scene takes beside the pull",
                               base::one_line(duration.origin), others_s);
    }
    change = {"effects.constant_speed.pull", fmt::format("{} s", pull_s), duration.origin};
  }
  // Anew: what has been read cannot be changed.
  std::vector<SceneChange> all = changes.changes;
  all.push_back(std::move(change));
  settings = changed_settings(file, all);
  if (!settings) return tl::unexpected(settings.error());
  return read_scene(*settings, file);
}

base::Result<Scene> parse_scene(std::string_view text, const std::filesystem::path& file) {
  base::Result<Settings> settings = Settings::parse(text, file.string());
  if (!settings) return tl::unexpected(settings.error());
  return read_scene(*settings, file);
}

}  // namespace stickslip::sim

#include "cli/scene_options.hpp"

#include <charconv>
#include <limits>
#include <optional>

#include "cli/options.hpp"
#include "io/library.hpp"

#include "core/base/wording.hpp"

namespace stickslip::cli {

using base::Dimension;
using base::Result;

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("scene", options.scene, "file, or name as in stickslip scenes")
      ->required()
      ->type_name("SCENE");
  command.add_option("--seed", options.seed, "seed of the random numbers; else that of the scene")
      ->type_name("N");
  command.add_option("--set", options.set, "change a key of the scene; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command.add_option("--without", options.without, "drop a listed effect; may be repeated")
      ->allow_extra_args(false)
      ->type_name("EFFECT");
  command
      .add_option("--duration", options.duration,
                  "length of the whole scene, with unit: \"20 s\"; the pull takes up the difference")
      ->type_name("T");
  command.add_option("--rate", options.rate, "scan rate, with unit: \"2 kHz\"; else that of the scene")
      ->type_name("HZ");
  command.add_option("--folder", options.folder, "of the scenes that have names")->type_name("DIR");
}

/// First what is dropped, so that it can be set anew in another way.
Result<sim::SceneChanges> changes_of(const SceneOptions& options) {
  sim::SceneChanges changes;
  for (const std::string& effect : options.without) {
    changes.changes.push_back({"effects." + effect, std::nullopt, "--without " + effect});
  }
  for (const std::string& setting : options.set) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      return base::usage_error("--set {}: needs a key and a value, such as paper.mu_s=0.34", setting);
    }
    changes.changes.push_back({setting.substr(0, equals), setting.substr(equals + 1), "--set " + setting});
  }
  const auto rate_Hz = number_of("--rate", options.rate, Dimension::kFrequency, true);
  if (!rate_Hz) return tl::unexpected(rate_Hz.error());
  if (*rate_Hz)
    changes.changes.push_back({"scan_rate", fmt::format("{} Hz", **rate_Hz), "--rate " + options.rate});
  const auto duration_s = number_of("--duration", options.duration, Dimension::kTime, true);
  if (!duration_s) return tl::unexpected(duration_s.error());
  if (*duration_s) changes.duration = {**duration_s, "--duration " + options.duration};
  return changes;
}

Result<std::uint64_t> seed_of(const SceneOptions& options, const sim::Scene& scene) {
  if (options.seed.empty()) return scene.seed;
  return whole_number_of("--seed", options.seed, 0, std::numeric_limits<std::uint64_t>::max());
}

Result<ChosenScene> chosen_scene(const SceneOptions& options) {
  const Result<sim::SceneChanges> changes = changes_of(options);
  if (!changes) return tl::unexpected(changes.error());
  const Result<std::filesystem::path> file = io::find_in(io::kScenes, options.scene, options.folder);
  if (!file) return tl::unexpected(file.error());
  Result<sim::Scene> scene = sim::load_scene(*file, *changes);
  if (!scene) return tl::unexpected(scene.error());
  const Result<std::uint64_t> seed = seed_of(options, *scene);
  if (!seed) return tl::unexpected(seed.error());
  return ChosenScene{*std::move(scene), *seed};
}

Result<std::uint64_t> whole_number_of(const char* option, std::string_view text, std::uint64_t min,
                                      std::uint64_t max) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || stop != end || number < min || number > max) {
    return base::usage_error("{} {}: must be a whole number from {} to {}", option, base::one_line(text), min,
                             max);
  }
  return number;
}

}  // namespace stickslip::cli

/// \file
/// Options of the commands that run scenes, as typed; numbers "350", "350 Hz", bare ones in SI units.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/result.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::cli {

struct SceneOptions {
  std::string scene;                 ///< File, or name of a shipped scene.
  std::string folder;                ///< Of the shipped scenes; empty: where the program finds them.
  std::string seed;                  ///< Empty: that of the scene.
  std::vector<std::string> without;  ///< Effects.
  std::vector<std::string> set;      ///< "key=value"
  std::string rate;
  std::string duration;
};

void add_scene_options(CLI::App& command, SceneOptions& options);

/// What the options make different from the scene's file. Usage error that names the option.
[[nodiscard]] base::Result<sim::SceneChanges> changes_of(const SceneOptions& options);

/// That of the option, else of the scene. Usage error that names the option.
[[nodiscard]] base::Result<std::uint64_t> seed_of(const SceneOptions& options, const sim::Scene& scene);

struct ChosenScene {
  sim::Scene scene;
  std::uint64_t seed = 0;
};

/// The scene with all its options. Usage error: as io::find_in(), changes_of(), sim::load_scene(), seed_of().
[[nodiscard]] base::Result<ChosenScene> chosen_scene(const SceneOptions& options);

/// Usage error that names the option, the text and the range.
[[nodiscard]] base::Result<std::uint64_t> whole_number_of(const char* option, std::string_view text,
                                                          std::uint64_t min, std::uint64_t max);

}  // namespace stickslip::cli

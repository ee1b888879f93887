/// \file
/// A scene in which nothing moves, so that its readings are what its effects make of zero volts.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"

namespace stickslip::sim {

/// Ten lines, at rest. The unit of force is 1 N/V, that of the coefficient 1 V.
inline std::string scene_at_rest(const std::string& duration = "1 s") {
  return "description = \"d\"\nscan_rate = \"350 Hz\"\nduration = \"" + duration +
         "\"\n[tester]\nsled_mass = \"1 kg\"\ngravity = \"1 m/s^2\"\nfrequency = \"20 Hz\"\n"
         "load_cell_gain = \"1 N/V\"\n[paper]\nmu_s = 0.35\nmu_k = 0.30\n";
}

inline Scene scene_of(const std::string& text) {
  base::Result<Scene> scene = parse_scene(text, "test.toml");
  if (!scene) throw std::runtime_error(scene.error().message);
  return *scene;
}

/// The error's message, or "" if the scene is accepted.
inline std::string refusal_of(const std::string& text) {
  const base::Result<Scene> scene = parse_scene(text, "test.toml");
  if (scene) return "";
  EXPECT_EQ(scene.error().kind, base::ErrorKind::kUsage);
  return scene.error().message;
}

inline std::vector<double> readings_of(const std::string& text) {
  const Scene scene = scene_of(text);
  SceneRun run{scene, scene.scan_rate_Hz};
  std::vector<double> raw(static_cast<std::size_t>(scan_count(scene, scene.scan_rate_Hz)));
  raw.resize(run.next(raw));
  return raw;
}

}  // namespace stickslip::sim

/// \file
/// Scene: settings of a simulated test of one paper on one tester.
///
///     base::Result<Scene> scene = load_scene("config/scenes/stick-slip-at-12-in-per-min.toml");
///
/// A scene lists its effects; others are not simulated. They act in four stages, in this order: motion (of
/// the sled), transducer (response of load cell and filter), sampling (instants of the converter) and signal
/// (noise and quantisation of the voltage). A new effect is a setting of its stage, a reader in
/// scene_file*.cpp, and a part of motion_of() or of SceneRun.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/model/oscillator.hpp"
#include "core/model/pull_speed.hpp"
#include "core/model/tester.hpp"
#include "core/model/transducer.hpp"
#include "core/sim/motion.hpp"
#include "core/sim/sampling_settings.hpp"
#include "core/sim/signal_settings.hpp"

namespace stickslip::sim {

/// The load cell with its amplifier: voltage = zero + force/gain.
struct SceneLoadCell {
  double gain_N_per_V = 1.0;
  double zero_V = 0.0;
};

/// Effect `constant_speed` (motion): a whole test as an operator runs it.
struct ConstantSpeed {
  double idle_s = 0.0;                ///< At rest before the pull, for the scans before the trigger.
  double pull_speed_m_per_s = 0.0;    ///< > 0
  double pull_s = 0.0;                ///< > 0
  double stop_s = 0.0;                ///< Belt at rest, coupling left stretched.
  double return_speed_m_per_s = 0.0;  ///< > 0; the carriage goes back until the force is zero.
  double return_s = 0.0;              ///< For the return and a wait; too short, it leaves a force.
  double rest_s = 0.0;                ///< Belt at rest, before the next test.

  [[nodiscard]] double duration_s() const noexcept { return idle_s + pull_s + stop_s + return_s + rest_s; }
};

// Effects that shape the pull of `constant_speed` (motion); at most one of them.

/// Effect `speed_ramp`: during the pull the speed changes linearly from the pull speed to another.
struct SpeedRamp {
  double to_m_per_s = 0.0;  ///< ≥ 0
};

/// Effect `exponential_start`: a motor that approaches the pull speed V as V (1 − e^(−t/τ)).
struct ExponentialStart {
  double time_constant_s = 0.0;  ///< τ > 0
};

/// Effect `jerk_limited_start`: the belt reaches the pull speed V after 2√(V/j), its acceleration first
/// rising, then falling.
struct JerkLimitedStart {
  double jerk_m_per_s3 = 0.0;  ///< j > 0, with 2√(V/j) ≤ pull_s.
};

/// Effect `piecewise_speed` (motion), in place of `constant_speed`: the speed is linear between points.
/// Before the first point the belt is at rest; after the last it keeps that speed to the end of the scene.
/// Two points at one time are a jump.
struct PiecewiseSpeed {
  struct Point {
    double at_s = 0.0;  ///< After the start of the scene; never before the point before.
    double speed_m_per_s = 0.0;
  };
  std::vector<Point> points;  ///< At least one.
};

/// Effect `onset_convention` (motion): which force has to reach S for the slip to start.
enum class OnsetConvention { kSpring, kSpringAndDamper };

/// Effect `stribeck` (motion): friction falls with rising sliding speed, as VelocityDependence has it.
struct Stribeck {
  double rise = 0.0;
  double speed_m_per_s = 0.0;
  double exponent = 2.0;
};

/// Settings of a simulated test; effects that are absent or false are not simulated.
struct Scene {
  std::string name;         ///< The file's name without its ending.
  std::string description;  ///< One line for people.
  /// Complete text of the file; with SceneChanges, of a file that gives this scene. Members set later do not
  /// change it.
  std::string text;
  std::uint64_t seed = 1;
  double scan_rate_Hz = 350.0;  ///< Nominal; unless the board is asked for another.
  double duration_s = 0.0;      ///< Of one repetition.
  double accuracy = 1e-9;       ///< Asked of the coefficient; matters only to a motion without closed form.

  double sled_mass_kg = 0.0;
  double gravity_m_per_s2 = model::kStandardGravity_m_per_s2;
  model::Oscillator oscillator;  ///< With the damping, if listed.
  SceneLoadCell load_cell;

  // Before the effects.
  double mu_s = 0.0;
  double mu_k = 0.0;

  std::optional<ConstantSpeed> constant_speed;
  std::optional<SpeedRamp> speed_ramp;
  std::optional<ExponentialStart> exponential_start;
  std::optional<JerkLimitedStart> jerk_limited_start;
  std::optional<PiecewiseSpeed> piecewise_speed;
  std::optional<double> startup_slack_m;  ///< Effect `startup_slack` (motion): > 0; with one_way_coupling.
  std::optional<KineticDrift> kinetic_drift;
  bool damping = false;
  bool one_way_coupling = false;
  PaperSettings paper;  ///< Effects that change S and K: `scatter`, `first_peak`, `contact_ageing`.
  std::optional<OnsetConvention> onset_convention;    ///< Absent: kSpring.
  std::optional<double> velocity_dependence_s_per_m;  ///< Effect `velocity_dependence`: dK/dV.
  std::optional<Stribeck> stribeck;
  std::optional<RateAndState> rate_and_state;
  std::optional<model::LoadCellDynamics> load_cell_dynamics;
  std::optional<model::AntiAlias> anti_alias;
  std::optional<ClockRateError> clock_rate_error;
  std::optional<ClockJitter> clock_jitter;
  std::optional<MissingScans> missing_scans;
  std::optional<WhiteNoise> white_noise;
  std::optional<DriftNoise> drift_noise;
  std::optional<MainsHum> mains_hum;
  std::optional<Spikes> spikes;
  std::optional<Quantisation> quantisation;

  [[nodiscard]] double normal_load_N() const noexcept { return sled_mass_kg * gravity_m_per_s2; }
};

/// Change of a scene file: sets a key, or removes a key or table, such as an effect.
struct SceneChange {
  std::string path;                  ///< Dotted, such as "paper.mu_s" or "effects.damping".
  std::optional<std::string> value;  ///< TOML, strings with or without quotes; absent: remove.
  std::string origin;                ///< Names the change in messages: the option as typed.
};

/// Duration asked of a whole scene.
struct SceneDuration {
  double seconds = 0.0;
  std::string origin;  ///< Names it in messages: the option as typed.
};

/// Changes to a scene file.
struct SceneChanges {
  std::vector<SceneChange> changes;  ///< In this order.
  /// Duration of the whole scene, applied last. It sets the pull of `constant_speed` to what the other phases
  /// leave, or, without that effect, the key `duration`.
  std::optional<SceneDuration> duration;
};

/// Reads a scene file and applies the changes. Usage error with file, line, value and what is allowed:
/// unreadable file, invalid TOML, unknown or missing key, unknown effect, effects that exclude each other,
/// missing or wrong unit, value out of range, S < K. Usage error too: a change that base::Settings refuses,
/// such as the removal of what is absent, and a duration too short for the phases beside the pull. An error
/// caused by a change names its origin instead of the line.
[[nodiscard]] base::Result<Scene> load_scene(const std::filesystem::path& file,
                                             const SceneChanges& changes = {});
/// Parses the text of a scene; usage errors as of load_scene(). \param file  stands for the file in messages
/// and gives the scene its name; it is not read.
[[nodiscard]] base::Result<Scene> parse_scene(std::string_view text, const std::filesystem::path& file);

/// The motion stage of the scene.
[[nodiscard]] Motion motion_of(const Scene& scene);

/// Interval in which the belt pulls; true seconds after the start of the scene.
struct Pull {
  double start_s = 0.0;
  double end_s = 0.0;
};

/// The pull of `constant_speed`; or of `piecewise_speed`, from the start of the first movement, in either
/// direction, to the end of the last one or of the scene. A movement after the end of the scene
/// counts too: start_s may then exceed end_s. nullopt if the belt never moves.
[[nodiscard]] std::optional<Pull> pull_of(const Scene& scene);

/// Pull speed of `constant_speed`, which is reached later with `exponential_start` or `jerk_limited_start`;
/// nullopt with `speed_ramp`, and without `constant_speed` (also for a `piecewise_speed` that is steady).
[[nodiscard]] std::optional<double> steady_pull_speed_m_per_s(const Scene& scene);

/// Belt speed over time, counted from the first movement; nullopt for `constant_speed` without an effect that
/// shapes its pull, for one speed from the first movement on, and for a belt that never moves forwards. Of
/// `constant_speed` it shows pull and stop, not the return of the carriage, whose end depends on the force.
/// If stop_s is 0, and after the last point of `piecewise_speed`, the last speed goes on for ever. Curves are
/// approximated by lines within 0.1 % of the speed's change. nullopt too if it needs more points than
/// PullSpeed::kMostPoints.
[[nodiscard]] std::optional<model::PullSpeed> pull_speed_of(const Scene& scene);

/// True scan rate at this nominal rate, with the clock's error.
[[nodiscard]] double true_scan_rate_Hz(const Scene& scene, double scan_rate_Hz) noexcept;

/// Number of scans of one repetition at this nominal rate, missing ones too: all that are before its end.
[[nodiscard]] std::int64_t scan_count(const Scene& scene, double scan_rate_Hz) noexcept;

}  // namespace stickslip::sim

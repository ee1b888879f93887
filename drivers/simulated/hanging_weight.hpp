/// \file
/// Simulated weight on the load cell, to rehearse a calibration without hardware. It replaces the scene's
/// force. A file holds the mass, so that a shell, a script or a test can change it.
#pragma once

#include <array>
#include <filesystem>
#include <random>
#include <span>

#include <boost/random/normal_distribution.hpp>

#include "core/base/scan_index.hpp"
#include "core/daq/board.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::drivers {

class HangingWeight {
 public:
  /// Frequency of a pendulum of 25 cm, the length of a hook.
  static constexpr double kSwing_Hz = 1.0;
  /// Standard deviation of a scan where the scene lists no white noise: a quiet amplifier before 16 bits of
  /// 20 V.
  static constexpr double kNoise_V = 0.0003;

  /// \param file  holds a mass in kg, and if the weight swings by how much of it the reading does, in kg:
  /// "0.5" or "0.5 0.01". While it is not there nothing is hung, and the scene plays; what cannot be
  /// understood (a file half written) leaves things as they were.
  /// \param scene  its load cell, gravity, noise and converter.
  /// \param board  read through the same converter.
  HangingWeight(const std::filesystem::path& file, const sim::Scene& scene, const daq::BoardInfo& board);

  /// Reads the file. Does not allocate.
  void look() noexcept;
  /// If a weight hangs, replaces `raw` with the converter's readings of it. \param first  index of raw[0].
  void read(base::ScanIndex first, std::span<double> raw) noexcept;

 private:
  std::filesystem::path file_;
  sim::SceneLoadCell load_cell_;
  double gravity_m_per_s2_;
  double scan_rate_Hz_;
  bool counts_;
  double maxdata_;
  double range_min_V_;
  double codes_per_V_;
  bool hangs_ = false;
  double mass_kg_ = 0.0;
  double swing_kg_ = 0.0;
  std::mt19937_64 generator_;
  boost::random::normal_distribution<double> noise_V_;
};

}  // namespace stickslip::drivers

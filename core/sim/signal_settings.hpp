/// \file
/// Settings of the signal stage. Sizes are volts at the converter.
#pragma once

#include <cstdint>
#include <vector>

namespace stickslip::sim {

/// Effect `white_noise`: independent normal numbers added to the voltage.
struct WhiteNoise {
  double sd_V = 0.0;
};

/// Effect `drift_noise`: noise whose density is proportional to 1/f between two frequencies.
struct DriftNoise {
  double sd_V = 0.0;                  ///< Of the whole drift.
  double lowest_frequency_Hz = 0.0;   ///< > 0
  double highest_frequency_Hz = 0.0;  ///< At least ten times the lowest.
};

/// Effect `mains_hum`: Σ amplitude · share · sin(2π · order · frequency · t + phase), t after the first scan.
struct MainsHum {
  struct Harmonic {
    int order = 1;
    double share = 1.0;  ///< Amplitude over that of the fundamental.
    double phase_rad = 0.0;
  };
  double frequency_Hz = 50.0;
  double amplitude_V = 0.0;
  std::vector<Harmonic> harmonics;  ///< All that are added: the fundamental too, first.
};

/// Effect `spikes`: errors of single scans, at the times of a Poisson process, equally likely up and down.
struct Spikes {
  enum class Sizes { kFixed, kUniform, kExponential };
  double rate_per_s = 0.0;
  double mean_size_V = 0.0;
  Sizes sizes = Sizes::kExponential;  ///< Uniform: from nothing to twice the mean.
};

/// Effect `quantisation`: an ideal A/D converter that saturates at its rails.
struct Quantisation {
  int bits = 16;  ///< 1 … 32
  double range_min_V = -10.0;
  double range_max_V = 10.0;  ///< > range_min_V

  /// Highest count, 2^bits − 1.
  [[nodiscard]] std::uint32_t maxdata() const noexcept {
    return static_cast<std::uint32_t>((std::uint64_t{1} << static_cast<unsigned>(bits)) - 1);
  }
  bool operator==(const Quantisation&) const = default;
};

}  // namespace stickslip::sim

#include "drivers/simulated/hanging_weight.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "core/sim/random_stream.hpp"

namespace stickslip::drivers {
namespace {

/// Longer than any two numbers.
constexpr std::size_t kLongestText = 64;

}  // namespace

HangingWeight::HangingWeight(const std::filesystem::path& file, const sim::Scene& scene,
                             const daq::BoardInfo& board)
    : file_(file),
      load_cell_(scene.load_cell),
      gravity_m_per_s2_(scene.gravity_m_per_s2),
      scan_rate_Hz_(board.scan_rate_granted_Hz),
      counts_(board.quantity == daq::RawQuantity::kCounts),
      maxdata_(board.maxdata),
      range_min_V_(board.range_min_V),
      codes_per_V_(counts_ ? maxdata_ / (board.range_max_V - board.range_min_V) : 0.0),
      generator_(sim::stream_seed(scene.seed, "hanging_weight")),
      noise_V_(0.0, scene.white_noise ? scene.white_noise->sd_V : kNoise_V) {}

void HangingWeight::look() noexcept {
  const int descriptor = ::open(file_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    hangs_ = false;
    return;
  }
  std::array<char, kLongestText> text{};
  const ssize_t size = ::read(descriptor, text.data(), text.size());
  ::close(descriptor);
  if (size <= 0) return;
  const char* const end = text.data() + size;
  const char* at = text.data();
  const auto number = [&at, end](double& value) {
    while (at != end && (*at == ' ' || *at == '\n')) ++at;
    const auto [stopped, error] = std::from_chars(at, end, value);
    at = stopped;
    return error == std::errc{} && std::isfinite(value);
  };
  double mass_kg = 0.0;
  if (!number(mass_kg)) return;
  double swing_kg = 0.0;
  if (!number(swing_kg)) swing_kg = 0.0;
  hangs_ = true;
  mass_kg_ = mass_kg;
  swing_kg_ = swing_kg;
}

void HangingWeight::read(base::ScanIndex first, std::span<double> raw) noexcept {
  if (!hangs_) return;
  for (double& value : raw) {
    const double time_s = static_cast<double>(first++) / scan_rate_Hz_;
    const double felt_kg = mass_kg_ + swing_kg_ * std::sin(2.0 * std::numbers::pi * kSwing_Hz * time_s);
    const double volts =
        load_cell_.zero_V + felt_kg * gravity_m_per_s2_ / load_cell_.gain_N_per_V + noise_V_(generator_);
    value = counts_ ? std::clamp(std::round((volts - range_min_V_) * codes_per_V_), 0.0, maxdata_) : volts;
  }
}

}  // namespace stickslip::drivers

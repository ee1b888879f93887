#include "core/sim/missing_scans.hpp"

#include <cmath>

#include "core/sim/random_stream.hpp"

namespace stickslip::sim {

MissingBursts::MissingBursts(const MissingScans& settings, double scan_rate_Hz)
    : mean_wait_scans_(scan_rate_Hz / settings.rate_per_s),
      length_scale_scans_(-1.0 / std::log1p(-1.0 / settings.mean_length_scans)) {}

void MissingBursts::restart(std::uint64_t seed) {
  generator_.seed(stream_seed(seed, kName));
  end_ = 0;
  next();
}

void MissingBursts::next() {
  first_ = ScanTime{end_, 0.0}.later(mean_wait_scans_ * exponential_(generator_)).scan;
  end_ = ScanTime{first_, 0.0}.later(1.0 + length_scale_scans_ * exponential_(generator_)).scan;
}

}  // namespace stickslip::sim

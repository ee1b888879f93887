#include "core/sim/clock_jitter.hpp"

#include <algorithm>
#include <cmath>

#include "core/sim/random_stream.hpp"

namespace stickslip::sim {

void JitteringClock::restart(std::uint64_t seed) {
  generator_.seed(stream_seed(seed, kName));
  normal_.reset();
  last_ = {};
}

ScanTime JitteringClock::instant(std::int64_t scan) {
  const double late = sd_scans_ * normal_(generator_);
  const double whole = std::floor(late);
  ScanTime instant{scan + static_cast<std::int64_t>(whole), late - whole};
  if (instant.fraction >= 1.0) instant = {instant.scan + 1, 0.0};  // Early by less than a rounding.
  last_ = std::max(last_, instant);
  return last_;
}

}  // namespace stickslip::sim

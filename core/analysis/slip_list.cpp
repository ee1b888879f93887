#include "core/analysis/slip_list.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// Fewest falls that have a meaningful median.
constexpr std::size_t kFewestForMedian = 3;
/// Smallest median trough, as a fraction of the median peak, both above the level where the first rise began,
/// at which that level is the unloaded force. If the troughs are lower, the trace begins within a test, or
/// slips unload the coupling fully.
constexpr double kLoaded = 0.2;
/// A first fall whose peak is below this fraction of the load comes before the loading.
constexpr double kNotLoaded = 0.25;
/// A first or last fall that ends within this fraction of the load from the unloaded force is not a slip: it
/// is the unloading, or lies before or after the test.
constexpr double kAtRest = 0.05;
/// Fraction of half an oscillation below which the distance from a trough to the next peak shows one split
/// slip; in the model it is at least 1.
constexpr double kShortestHalf = 0.5;
/// A last fall is not a slip if it is later than kLate half oscillations after the one before, so that it is
/// no free oscillation, and the force has risen with less than kFlat times the usual slope, so that the sled
/// did not stick to a moving belt.
constexpr double kLate = 3.2;
constexpr double kFlat = 0.25;
/// A fall whose duration, increased by one scan, is below this fraction of the median is a step between two
/// spikes: a slip of the model takes 0.3 of an oscillation, whatever its size.
constexpr double kQuick = 0.4;

/// Falls [first, end).
struct Part {
  const base::LongColumn<detect::Fall>& falls;
  std::size_t first;
  std::size_t end;

  [[nodiscard]] std::size_t size() const noexcept { return end - first; }
  [[nodiscard]] detect::Fall operator[](std::size_t i) const { return falls[first + i]; }
  [[nodiscard]] detect::Fall back() const { return falls[end - 1]; }

  template <typename Value>
  [[nodiscard]] double median(const Value& value) const {
    return signal::median_of(size(), [&](std::size_t i) { return value((*this)[i]); });
  }
};

double half_of(const Part& part) {
  return part.median([](const detect::Fall& fall) { return fall.trough_at - fall.peak_at; });
}

void keep_loaded(Part& part) {
  const double rest = part[0].rise_from;
  const double load = part.median([](const detect::Fall& fall) { return fall.peak; }) - rest;
  const double trough = part.median([](const detect::Fall& fall) { return fall.trough; }) - rest;
  const bool from_rest = trough >= kLoaded * load;
  const auto loading = [&](const detect::Fall& fall) {
    // Where a trace begins in the middle of a test, the first fall may be seen without its rise.
    return fall.peak - rest > kNotLoaded * load ||
           (!from_rest && std::abs(fall.trough - rest) > kNotLoaded * load);
  };
  while (part.size() > 0 && !loading(part[0])) ++part.first;
  if (!from_rest) return;
  const auto loaded = [&](const detect::Fall& fall) { return std::abs(fall.trough - rest) > kAtRest * load; };
  while (part.size() > 0 && !loaded(part[0])) ++part.first;
  while (part.size() > 0 && !loaded(part.back())) --part.end;
}

double slope_between(const detect::Fall& before, const detect::Fall& after) noexcept {
  return (after.peak - before.trough) / (after.peak_at - before.trough_at);
}

void end_with_the_pull(Part& part) {
  const double half = half_of(part);
  const double typical =
      signal::median_of(part.size() - 1, [&](std::size_t i) { return slope_between(part[i], part[i + 1]); });
  while (part.size() > kFewestForMedian) {
    const detect::Fall before = part[part.size() - 2];
    const bool late = part.back().peak_at - before.peak_at > kLate * half;
    if (!late || slope_between(before, part.back()) >= kFlat * typical) return;
    --part.end;
  }
}

/// `fall` goes on where `before` has paused.
void join(detect::Fall& before, const detect::Fall& fall) noexcept {
  if (fall.trough >= before.trough) return;
  before.duration += fall.trough_at - before.trough_at;
  before.robust_drop += before.trough - fall.trough;
  before.trough = fall.trough;
  before.trough_at = fall.trough_at;
}

base::LongColumn<detect::Fall> joined_halves(const Part& part, const std::filesystem::path& scratch) {
  const double half = half_of(part);
  const double quick = kQuick * part.median([](const detect::Fall& fall) { return fall.duration; }) - 1.0;
  base::LongColumn<detect::Fall> joined{scratch};
  std::size_t i = 0;
  while (part[i].duration < quick) ++i;  // The median is not.
  detect::Fall latest = part[i];
  for (++i; i < part.size(); ++i) {
    const detect::Fall fall = part[i];
    if (fall.duration < quick) continue;
    if (fall.peak_at - latest.trough_at >= kShortestHalf * half) {
      joined.push_back(std::exchange(latest, fall));
    } else {
      join(latest, fall);
    }
  }
  joined.push_back(latest);
  return joined;
}

}  // namespace

base::LongColumn<detect::Fall> kept_slips(base::LongColumn<detect::Fall> falls,
                                          const std::filesystem::path& scratch) {
  if (falls.size() < kFewestForMedian) return falls;
  Part part{falls, 0, falls.size()};
  keep_loaded(part);
  if (part.size() >= kFewestForMedian) {
    end_with_the_pull(part);
    return joined_halves(part, scratch);
  }
  base::LongColumn<detect::Fall> kept{scratch};
  for (std::size_t i = 0; i < part.size(); ++i) kept.push_back(part[i]);
  return kept;
}

}  // namespace stickslip::analysis

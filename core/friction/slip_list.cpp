#include "core/friction/slip_list.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/signal/statistics.hpp"

namespace stickslip::friction {
namespace {

/// Fewest falls of which a median is typical.
constexpr std::size_t kFewestForMedian = 3;
/// Rest, from which the force was loaded, is where the first rise began; if the troughs are not even this
/// part of the way up to the peaks, the trace begins in the middle of a test, or slips may end at rest.
constexpr double kLoaded = 0.2;
/// A first fall that stays within this part of the load from rest comes before the loading.
constexpr double kNotLoaded = 0.25;
/// A fall to within this part of the load from rest is the unloading, or comes before or after all load.
constexpr double kAtRest = 0.05;
/// In the model, peak and trough are half an oscillation apart, and so are trough and next peak at least.
constexpr double kShortestHalf = 0.5;
/// A last fall later than this many halves after the one before is no free oscillation, and if the force has
/// climbed less steeply than this part of the usual, the sled did not stick to a moving belt either.
constexpr double kLate = 3.2;
constexpr double kFlat = 0.25;

template <typename Value>
double median_of(const std::vector<Fall>& falls, const Value& value) {
  std::vector<double> values;
  values.reserve(falls.size());
  for (const Fall& fall : falls) values.push_back(value(fall));
  return signal::median(values);
}

void keep_loaded(std::vector<Fall>& falls) {
  const double rest = falls.front().rise_from;
  const double load = median_of(falls, [](const Fall& fall) { return fall.peak; }) - rest;
  const double trough = median_of(falls, [](const Fall& fall) { return fall.trough; }) - rest;
  const auto loading = std::find_if(falls.begin(), falls.end(), [&](const Fall& fall) {
    return fall.peak - rest > kNotLoaded * load || std::abs(fall.trough - rest) > kNotLoaded * load;
  });
  falls.erase(falls.begin(), loading);
  if (trough < kLoaded * load) return;
  const auto loaded = [&](const Fall& fall) { return std::abs(fall.trough - rest) > kAtRest * load; };
  falls.erase(falls.begin(), std::find_if(falls.begin(), falls.end(), loaded));
  falls.erase(std::find_if(falls.rbegin(), falls.rend(), loaded).base(), falls.end());
}

double slope_between(const Fall& before, const Fall& after) noexcept {
  return (after.peak - before.trough) / (after.peak_at - before.trough_at);
}

void end_with_the_pull(std::vector<Fall>& falls) {
  const double half = median_of(falls, [](const Fall& fall) { return fall.trough_at - fall.peak_at; });
  std::vector<double> slopes;
  for (std::size_t i = 0; i + 1 < falls.size(); ++i) slopes.push_back(slope_between(falls[i], falls[i + 1]));
  const double typical = signal::median(slopes);
  while (falls.size() > kFewestForMedian) {
    const Fall& before = falls[falls.size() - 2];
    const bool late = falls.back().peak_at - before.peak_at > kLate * half;
    if (!late || slope_between(before, falls.back()) >= kFlat * typical) return;
    falls.pop_back();
  }
}

void join_halves(std::vector<Fall>& falls) {
  const double half = median_of(falls, [](const Fall& fall) { return fall.trough_at - fall.peak_at; });
  std::vector<Fall> joined;
  joined.reserve(falls.size());
  for (const Fall& fall : falls) {
    if (joined.empty() || fall.peak_at - joined.back().trough_at >= kShortestHalf * half) {
      joined.push_back(fall);
      continue;
    }
    Fall& before = joined.back();
    if (fall.trough >= before.trough) continue;
    before.duration += fall.trough_at - before.trough_at;
    before.robust_drop += before.trough - fall.trough;
    before.trough = fall.trough;
    before.trough_at = fall.trough_at;
  }
  falls = std::move(joined);
}

}  // namespace

void keep_slips(std::vector<Fall>& falls) {
  if (falls.size() < kFewestForMedian) return;
  keep_loaded(falls);
  if (falls.size() < kFewestForMedian) return;
  end_with_the_pull(falls);
  join_halves(falls);
}

}  // namespace stickslip::friction

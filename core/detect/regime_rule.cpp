#include "core/detect/regime_rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stickslip::detect {

namespace {

/// Log-likelihood of a course of slip ends over "all free", and the first slip that ends otherwise than the
/// one before.
struct Path {
  double log_likelihood = -std::numeric_limits<double>::infinity();
  std::size_t changed_at = 0;
  std::size_t captured = 0;  ///< Slips.

  [[nodiscard]] Path changed(double cost) const noexcept {
    return {log_likelihood - cost, changed_at, captured};
  }
  [[nodiscard]] Path with_captured(double ratio) const noexcept {
    return {log_likelihood + ratio, changed_at, captured + 1};
  }
};

const Path& likelier(const Path& a, const Path& b) noexcept {
  return b.log_likelihood > a.log_likelihood ? b : a;
}

/// The likeliest courses without and with changes, up to a slip [Viterbi, IEEE Trans. Inf. Theory 13:260–269,
/// 1967].
struct Courses {
  double all_captured = 0.0;
  double all_free = 0.0;
  std::size_t count = 0;
  Path mixed_captured;  ///< Mixed, the latest slip captured.
  Path mixed_free;

  void add(std::size_t slip, double ratio, double change) noexcept {
    const Path captured = mixed_captured;
    const Path free = mixed_free;
    if (count > 0) {
      mixed_captured = likelier({all_free - change, slip, 0}, likelier(captured, free.changed(change)))
                           .with_captured(ratio);
      mixed_free = likelier({all_captured - change, slip, count}, likelier(free, captured.changed(change)));
    }
    all_captured += ratio;
    ++count;
  }
  [[nodiscard]] const Path& mixed() const noexcept { return likelier(mixed_captured, mixed_free); }
};

/// Of a trace that the model does not describe: a slip's ratio counts up to 20 to 1, and slips change their
/// behaviour once in a hundred.
constexpr double kLargestDoubtfulRatio = 2.995732273553991;  // ln 20
constexpr double kChange = 4.605170185988091;                // ln 100

}  // namespace

RegimeVerdict judge_regime(std::size_t slip_count, const base::LongColumn<double>& log_likelihood_ratios,
                           Description description) {
  const auto undecided = [](std::string reason, std::size_t told = 0) {
    return RegimeVerdict{model::Regime::kUndecided, std::move(reason), {}, told, {}};
  };
  if (slip_count == 0) return {model::Regime::kSteadySliding, "no fall of the force is a slip", {}, 0, 0};
  if (log_likelihood_ratios.empty()) return undecided("one slip: nothing after it tells how it ended");
  const bool refuted = description == Description::kRefuted;
  const double largest = refuted ? kLargestDoubtfulRatio : std::numeric_limits<double>::infinity();
  const auto told = static_cast<std::size_t>(
      std::count_if(log_likelihood_ratios.begin(), log_likelihood_ratios.end(),
                    [](double ratio) { return ratio != 0.0; }));  // Else it says nothing.
  // A change may be between any two slips: of so many places chance alone makes the likeliest look like one.
  const double place = std::log(std::max(static_cast<double>(told) - 1.0, 1.0));
  const double change = refuted ? std::max(kChange, place) : place;
  Courses courses;
  std::size_t captured = 0;  // Each slip by itself.
  std::size_t slip = 0;
  for (const double ratio : log_likelihood_ratios) {
    if (ratio != 0.0) {
      courses.add(slip, std::clamp(ratio, -largest, largest), change);
      if (ratio > 0.0) ++captured;
    }
    ++slip;
  }
  if (told == 0) return undecided("no slip tells how it ended");
  if (description == Description::kDoubtful && captured != 0 && captured != told) {
    return undecided(
        fmt::format("{} of {} slips look captured, and no fit of the test tells which are", captured, told),
        told);
  }

  struct Class {
    model::Regime regime;
    double log_likelihood;
  };
  std::array<Class, 3> classes{{{model::Regime::kStickSlip, courses.all_captured},
                                {model::Regime::kRingDown, courses.all_free},
                                {model::Regime::kMixed, courses.mixed().log_likelihood}}};
  std::sort(classes.begin(), classes.end(),
            [](const Class& a, const Class& b) { return a.log_likelihood > b.log_likelihood; });
  const double lead = classes[0].log_likelihood - classes[1].log_likelihood;
  if (lead < std::log(kDecisiveLikelihoodRatio)) {
    return undecided(fmt::format("{} is only {:.1f} times as likely as {}, {:.0f} are wanted",
                                 model::name(classes[0].regime), std::exp(lead),
                                 model::name(classes[1].regime), kDecisiveLikelihoodRatio),
                     told);
  }
  RegimeVerdict verdict;
  verdict.regime = classes[0].regime;
  verdict.told = told;
  verdict.captured = verdict.regime == model::Regime::kStickSlip  ? told
                     : verdict.regime == model::Regime::kRingDown ? 0
                                                                  : courses.mixed().captured;
  verdict.reason = fmt::format("{} of {} slips ended in sticking", *verdict.captured, told);
  if (*verdict.captured != captured) verdict.reason += fmt::format(" (taken one by one: {})", captured);
  if (verdict.regime == model::Regime::kMixed) verdict.transition_slip = courses.mixed().changed_at;
  return verdict;
}

RegimeVerdict judge_by_shape(const CycleShape& shape, RegimeVerdict by_ends, bool model_describes) {
  constexpr std::size_t kFewestCycles = 8;
  constexpr double kDecays = 3.0;
  // A stick shorter than a twentieth of the oscillation cannot be told from none by turning points.
  constexpr double kNoRest = 1.1;
  if (shape.count < kFewestCycles || shape.decay_sigmas > kDecays) return by_ends;
  const std::string shape_text =
      fmt::format("the oscillation does not decay, and its rises last {:.2f} times as long as its falls",
                  shape.rise_over_fall);
  const bool rests = shape.rise_over_fall > kNoRest;
  if (!model_describes && !rests)
    return {model::Regime::kInertialOscillation, shape_text + ": the sled never rests", {}, by_ends.told, 0};
  const bool doubtful = by_ends.regime == model::Regime::kUndecided ||
                        (by_ends.regime == model::Regime::kRingDown && !model_describes);
  if (doubtful && rests)
    return {
        model::Regime::kStickSlip, shape_text + ": the sled rests between the slips", {}, by_ends.told, {}};
  return by_ends;
}

}  // namespace stickslip::detect

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

  [[nodiscard]] Path plus(double ratio) const noexcept { return {log_likelihood + ratio, changed_at}; }
};

const Path& likelier(const Path& a, const Path& b) noexcept {
  return b.log_likelihood > a.log_likelihood ? b : a;
}

/// The likeliest courses without and with changes, up to a slip [Viterbi, IEEE Trans. Inf. Theory 13:260–269,
/// 1967].
struct Courses {
  double all_captured = 0.0;
  double all_free = 0.0;
  Path mixed_captured;  ///< Mixed, the latest slip captured.
  Path mixed_free;

  void add(std::size_t slip, bool is_first, double ratio, double change) noexcept {
    const Path captured = mixed_captured;
    const Path free = mixed_free;
    if (!is_first) {
      mixed_captured =
          likelier({all_free - change, slip}, likelier(captured, free.plus(-change))).plus(ratio);
      mixed_free = likelier({all_captured - change, slip}, likelier(free, captured.plus(-change)));
    }
    all_captured += ratio;
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
  if (slip_count == 0) return {model::Regime::kSteadySliding, "no fall of the force is a slip", {}};
  if (log_likelihood_ratios.empty()) {
    return {model::Regime::kUndecided, "one slip: nothing after it tells how it ended", {}};
  }
  const bool refuted = description == Description::kRefuted;
  const double largest = refuted ? kLargestDoubtfulRatio : std::numeric_limits<double>::infinity();
  Courses courses;
  std::ptrdiff_t captured = 0;
  std::ptrdiff_t count = 0;
  std::size_t slip = 0;
  for (const double ratio : log_likelihood_ratios) {
    if (ratio != 0.0) {  // Else it says nothing.
      courses.add(slip, count == 0, std::clamp(ratio, -largest, largest), refuted ? kChange : 0.0);
      ++count;
      if (ratio > 0.0) ++captured;
    }
    ++slip;
  }
  if (count == 0) return {model::Regime::kUndecided, "no slip tells how it ended", {}};
  if (description == Description::kDoubtful && captured != 0 && captured != count) {
    return {
        model::Regime::kUndecided,
        fmt::format("{} of {} slips look captured, and no fit of the test tells which are", captured, count),
        {}};
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
    return {model::Regime::kUndecided,
            fmt::format("{} is only {:.1f} times as likely as {}, {:.0f} are wanted",
                        model::name(classes[0].regime), std::exp(lead), model::name(classes[1].regime),
                        kDecisiveLikelihoodRatio),
            {}};
  }
  RegimeVerdict verdict;
  verdict.regime = classes[0].regime;
  verdict.reason = fmt::format("{} of {} slips ended in sticking", captured, count);
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
    return {model::Regime::kInertialOscillation, shape_text + ": the sled never rests", {}};
  const bool doubtful = by_ends.regime == model::Regime::kUndecided ||
                        (by_ends.regime == model::Regime::kRingDown && !model_describes);
  if (doubtful && rests)
    return {model::Regime::kStickSlip, shape_text + ": the sled rests between the slips", {}};
  return by_ends;
}

}  // namespace stickslip::detect

/// \file
/// The friction law of a paper from tests at several pull speeds: do S and K depend on rest and speed?
///
///     S = S₁ + β log₁₀(t/1 s)
///
///     K = K₀ + μ′ v
///
/// t is how long the contact rested before the slip [Rabinowicz 1951; Dieterich 1972], v the pull speed.
///
/// Each of the two dependences may be absent, so that there are four nested laws. Which is named: the
/// smallest whose score on tests that it was not fitted to is within one standard error of the best [Breiman,
/// Friedman, Olshen and Stone, Classification and Regression Trees, 1984, 3.4.3]. A test is left out as a
/// whole: its slips share its place on the paper and its errors. The law is *told* where in addition
///
/// - each dependence that it has exceeds its 99 % interval and what the systematic parts could make, and
/// - each that it has not is, by its 95 % interval and with what the systematic parts could hide, at most a
///   tenth of S − K over a decade of speed.
///
/// A sheet with holds or several speeds counts as one test for each of them. Sheets that differ scatter as
/// such tests do, so that the error of a level found from few sheets is too small.
///
/// Tests whose speeds differ by at most 1 % have one speed: K is at their mean speed, S at their mean stick
/// time. A slip after a hold counts with its own stick time, which the belt set.
///
///     const FrictionLaw found = find_law(tests);
///     found.told ? name(found.law) : "cannot be told";
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/law/line.hpp"
#include "core/law/rate_and_state.hpp"

namespace stickslip::law {

/// A coefficient as one test gives it.
struct Value {
  double value = 0.0;
  double error = 0.0;       ///< > 0
  double systematic = 0.0;  ///< Moves with those of the other tests; below 0: the other way.
};

/// One test at one speed, or the slips of one speed or of one hold in a test that changes its speed. At least
/// one of S, with the stick time, and K is there.
struct LawTest {
  double pull_speed_m_per_s = 0.0;     ///< > 0
  std::optional<double> stick_time_s;  ///< Of its slips, geometric mean; > 0; with S.
  std::optional<Value> S;
  std::optional<Value> K;
  bool held = false;      ///< The belt stood still for the stick time, whatever its speed.
  std::size_t sheet = 0;  ///< Which sheet: one may count several times, by its rests.
};

/// In the order of their scores.
enum class Law { kConstant, kAgeing, kRate, kAgeingAndRate };
inline constexpr std::array kLaws{Law::kConstant, Law::kAgeing, Law::kRate, Law::kAgeingAndRate};

/// "constant", "ageing", "rate", "ageing-and-rate".
[[nodiscard]] std::string_view name(Law law) noexcept;
[[nodiscard]] constexpr bool has_ageing(Law law) noexcept {
  return law == Law::kAgeing || law == Law::kAgeingAndRate;
}
[[nodiscard]] constexpr bool has_rate(Law law) noexcept {
  return law == Law::kRate || law == Law::kAgeingAndRate;
}

/// How well a law predicts tests that it was not fitted to.
struct LawScore {
  double score = 0.0;         ///< Mean log density of a left-out test.
  double behind = 0.0;        ///< Mean of best less this; 0 for the best.
  double behind_error = 0.0;  ///< Standard error of that mean, over tests.
};

enum class Verdict { kYes, kNo, kCannotTell };

/// S over log₁₀ of the stick time, or K over the speed.
struct Dependence {
  std::vector<Point> points;
  std::vector<std::size_t> tests;  ///< Indices among the tests, one for each point.
  std::optional<Line> constant;
  std::optional<Line> line;         ///< With the slope: β or μ′.
  double slope_that_matters = 0.0;  ///< A tenth of S − K over a decade of speed.
  Verdict verdict = Verdict::kCannotTell;
  std::string reason;  ///< Why not, for people; set exactly for kCannotTell.
  /// For kCannotTell: chance alone would not keep it from being told, and the systematic part alone does.
  bool systematic_vetoes = false;

  [[nodiscard]] const std::optional<Line>& fitted(bool with_slope) const noexcept {
    return with_slope ? line : constant;
  }
};

/// Fewest tests with a value for a dependence to be told: a line through all but one leaves one degree of
/// freedom.
inline constexpr std::size_t kFewestTests = 4;

struct FrictionLaw {
  Law law = Law::kConstant;  ///< Named if `told` and not rate-and-state; else the leading one.
  bool told = false;
  [[nodiscard]] bool is_rate_and_state() const noexcept { return rate_and_state && rate_and_state->is_told; }
  std::optional<std::array<LawScore, kLaws.size()>> scores;  ///< Absent with fewer than kFewestTests.
  Dependence ageing;                                         ///< Of S.
  Dependence rate;                                           ///< Of K.
  /// Present where there are pulls and holds for it. If `is_told`, it is the law: no line over
  /// the time at rest alone then describes pulls and holds together.
  std::optional<RateAndState> rate_and_state;
  double delta_mu = 0.0;  ///< S − K, by whose tenth a dependence matters; a tenth of K where no test has S.
};

/// "rate-and-state", or the name of found.law.
[[nodiscard]] std::string_view name(const FrictionLaw& found) noexcept;

/// \param tests  at least one.
[[nodiscard]] FrictionLaw find_law(std::span<const LawTest> tests);

}  // namespace stickslip::law

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
/// A sheet with holds or several speeds counts as one test for each of them. These are taken as independent,
/// though one sheet has one level, so that the error of a level found from few sheets is too small.
///
/// Tests whose speeds differ by at most 1 % have one speed: K is at their mean speed, S at the geometric mean
/// of their stick times. A slip after a hold counts with its own stick time, which the belt set.
///
///     const FrictionLaw found = find_law(tests);
///     found.told ? name(found) : "cannot be told";
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
  double error = 0.0;       ///< Standard error, > 0.
  double systematic = 0.0;  ///< By how much it is off where all tests are off together; with its sign.
};

/// One test at one speed, or the slips of one speed or of one hold in a test that changes its speed. At least
/// one of S, with the stick time, and K is there.
struct LawTest {
  double pull_speed_m_per_s = 0.0;     ///< > 0
  std::optional<double> stick_time_s;  ///< Of its slips, geometric mean; > 0; required with S.
  std::optional<Value> S;
  std::optional<Value> K;
  /// The belt stood still for the stick time, whatever its speed. Such a test has S and no K.
  bool held = false;
  std::size_t sheet = 0;  ///< Number of the sheet, which all its tests share.
};

/// Also the indices of FrictionLaw::scores.
enum class Law {
  kConstant,      ///< S and K are constant.
  kAgeing,        ///< S depends on the stick time.
  kRate,          ///< K depends on the speed.
  kAgeingAndRate  ///< Both.
};
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
  /// Mean over the tests of the log density of the left-out S and K. A coefficient that a test lacks, or that
  /// fewer than kFewestTests tests have, adds 0.
  double score = 0.0;
  double behind = 0.0;        ///< Score of the best law less this one; 0 for the best.
  double behind_error = 0.0;  ///< Standard error of `behind`, by its scatter over the tests.
};

/// Whether a dependence is there. kNo: it is too small to matter.
enum class Verdict { kYes, kNo, kCannotTell };

/// S over log₁₀ of the stick time in s, or K over the speed in m/s.
struct Dependence {
  std::vector<Point> points;
  std::vector<std::size_t> tests;  ///< Indices among the tests, one for each point.
  std::optional<Line> constant;    ///< Absent with fewer than two points.
  std::optional<Line> line;  ///< With the slope, β or μ′; absent with fewer than three points or one place.
  /// As β or μ′: a tenth of FrictionLaw::delta_mu over a decade of speed about the geometric mean of the
  /// tests' speeds; 0: not known.
  double slope_that_matters = 0.0;
  Verdict verdict = Verdict::kCannotTell;  ///< kYes whatever the line if FrictionLaw::is_rate_and_state().
  std::string reason;                      ///< Why not, for people; set exactly for kCannotTell.
  /// For kCannotTell: chance alone would not keep it from being told, and the systematic part alone does.
  bool systematic_vetoes = false;

  [[nodiscard]] const std::optional<Line>& fitted(bool with_slope) const noexcept {
    return with_slope ? line : constant;
  }
};

/// Fewest tests with a value for a dependence to be told: a line through three leaves one degree of freedom.
inline constexpr std::size_t kFewestTests = 4;

struct FrictionLaw {
  /// The smallest law whose score is within a standard error of the best; kConstant without scores. Certain
  /// if `told`; not the law if is_rate_and_state().
  Law law = Law::kConstant;
  bool told = false;  ///< The tests tell the law, by the rules above; true if is_rate_and_state().
  [[nodiscard]] bool is_rate_and_state() const noexcept { return rate_and_state && rate_and_state->is_told; }
  /// Absent unless S or K has kFewestTests values.
  std::optional<std::array<LawScore, kLaws.size()>> scores;
  Dependence ageing;  ///< Of S.
  Dependence rate;    ///< Of K.
  /// Present where there are pulls and holds for it. If `is_told`, it is the law: no line over the time at
  /// rest alone then describes pulls and holds together. If not, and not `may_have_none`, no law is told.
  std::optional<RateAndState> rate_and_state;
  /// Mean S − K, by whose tenth a dependence matters, of the tests with both. A tenth of the largest K where
  /// none has both or the mean is not positive; 0 without a K above 0.
  double delta_mu = 0.0;
};

/// "rate-and-state", or the name of found.law.
[[nodiscard]] std::string_view name(const FrictionLaw& found) noexcept;

/// \param tests  at least one.
[[nodiscard]] FrictionLaw find_law(std::span<const LawTest> tests);

}  // namespace stickslip::law

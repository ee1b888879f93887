#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "tests/support/model_course.hpp"

namespace stickslip::analysis {
namespace {

struct Analysed {
  TestResults results;
  base::LongColumn<detect::Cycle> cycles;
  std::vector<base::ScanIndex> spikes;
};

struct Input {
  std::vector<double> values;
  std::vector<bool> saturated;  ///< Empty: none is.
  AnalysisSettings settings;
};

Analysed analyse(const Input& input, base::ScanIndex first = 0) {
  TestAnalysis analysis{input.settings};
  for (std::size_t k = 0; k < input.values.size(); ++k) {
    analysis.add(first + static_cast<base::ScanIndex>(k), input.values[k],
                 !input.saturated.empty() && input.saturated[k]);
  }
  Analysed analysed;
  analysed.results = analysis.finish();
  analysed.cycles = analysis.cycles();
  analysed.spikes = analysis.spikes();
  return analysed;
}

/// Unloaded, loaded, then sticks and slips or a ring-down, at any speed and noise; with a few spikes.
Input any_test() {
  const double Q = 0.01 * *rc::gen::inRange(30, 400);
  const bool captured = Q < 1.9;
  const int length = *rc::gen::inRange(2, 12);
  const double sigma = 1e-4 * *rc::gen::inRange(1, 30);
  const auto seed = *rc::gen::arbitrary<std::uint32_t>();
  const test::ModelCourse course =
      captured ? test::ModelCourse::captured(Q, length) : test::ModelCourse::free(Q, length);
  std::mt19937_64 engine{seed};
  std::normal_distribution<double> normal{0.0, sigma};
  Input input;
  for (int k = 0; k < 100; ++k)
    input.values.push_back(std::max(0.0, course.trace.value[0] * (k - 60) / 40.0));
  input.values.insert(input.values.end(), course.trace.value.begin(), course.trace.value.end());
  for (double& value : input.values) value += normal(engine);
  for (int spikes = *rc::gen::inRange(0, 3); spikes > 0; --spikes) {
    input.values[engine() % input.values.size()] += 1.0;
  }
  return input;
}

/// All results and cycles, as bits: NaN equals NaN.
std::vector<std::uint64_t> bits_of(const detect::Cycle& cycle) {
  std::vector<std::uint64_t> bits{static_cast<std::uint64_t>(cycle.number), cycle.flags};
  for (const double value :
       {cycle.onset_time_s, cycle.capture_time_s, cycle.peak_time_s, cycle.period_s, cycle.stick_time_s,
        cycle.slip_time_s, cycle.peak, cycle.trough, cycle.force_drop, cycle.delta_mu,
        cycle.delta_mu_standard_error, cycle.slip_speed_ratio}) {
    bits.push_back(std::bit_cast<std::uint64_t>(value));
  }
  return bits;
}

void assert_same(const Analysed& a, const Analysed& b, base::ScanIndex shift) {
  RC_ASSERT(a.results == b.results);
  RC_ASSERT(a.cycles.size() == b.cycles.size());
  for (std::size_t i = 0; i < a.cycles.size(); ++i) {
    RC_ASSERT(bits_of(a.cycles[i]) == bits_of(b.cycles[i]));
    RC_ASSERT(a.cycles[i].first_scan + shift == b.cycles[i].first_scan);
  }
  RC_ASSERT(a.spikes.size() == b.spikes.size());
  for (std::size_t i = 0; i < a.spikes.size(); ++i) RC_ASSERT(a.spikes[i] + shift == b.spikes[i]);
}

RC_GTEST_PROP(AnalysisProperty, SameScansGiveTheSameBits, ()) {
  const Input input = any_test();
  assert_same(analyse(input), analyse(input), 0);
}

// Time is the distance from the record's first scan: an acquisition that runs for years changes no bit.
RC_GTEST_PROP(AnalysisProperty, ScanNumbersDoNotMatter, ()) {
  const Input input = any_test();
  const auto shift = *rc::gen::inRange<base::ScanIndex>(-(1LL << 60), 1LL << 60);
  assert_same(analyse(input), analyse(input, shift), shift);
}

RC_GTEST_PROP(AnalysisProperty, LookingAtTheLiveCyclesChangesNothing, ()) {
  const Input input = any_test();
  TestAnalysis analysis{input.settings};
  std::size_t live = 0;
  for (std::size_t k = 0; k < input.values.size(); ++k) {
    analysis.add(static_cast<base::ScanIndex>(k), input.values[k], false);
    live += analysis.take_new_cycles().size();
  }
  RC_ASSERT(analysis.finish() == analyse(input).results);
  RC_ASSERT(live <= input.values.size());
}

// A gain of 2^n is exact in binary, and every rule is a ratio: coefficients scale, all else stays.
RC_GTEST_PROP(AnalysisProperty, PowerOfTwoGainScalesCoefficientsAndNothingElse, ()) {
  const Input input = any_test();
  const double gain = std::ldexp(1.0, *rc::gen::inRange(-10, 11));
  Input scaled = input;
  for (double& value : scaled.values) value *= gain;
  const Analysed a = analyse(input);
  const Analysed b = analyse(scaled);
  RC_ASSERT(a.results.regime == b.results.regime);
  RC_ASSERT(a.results.regime_reason == b.results.regime_reason);
  RC_ASSERT(a.spikes == b.spikes);
  for (const auto same : {&TestResults::cycle_count, &TestResults::stick_cycle_count,
                          &TestResults::period_median, &TestResults::spike_count}) {
    RC_ASSERT((a.results.*same) == (b.results.*same));
  }
  for (const auto proportional : {&TestResults::static_coefficient, &TestResults::kinetic_coefficient}) {
    RC_ASSERT((a.results.*proportional).value.has_value() == (b.results.*proportional).value.has_value());
    if ((a.results.*proportional).value) {
      RC_ASSERT(*(a.results.*proportional).value * gain == *(b.results.*proportional).value);
    }
  }
  RC_ASSERT(a.cycles.size() == b.cycles.size());
  for (std::size_t i = 0; i < a.cycles.size(); ++i) {
    RC_ASSERT(a.cycles[i].peak * gain == b.cycles[i].peak);
    RC_ASSERT(a.cycles[i].trough * gain == b.cycles[i].trough);
    RC_ASSERT(a.cycles[i].peak_time_s == b.cycles[i].peak_time_s);
    RC_ASSERT(a.cycles[i].flags == b.cycles[i].flags);
  }
  // The fit pivots on the largest of (ω, γ, r), which the gain moves: roundings differ, and where they are
  // at work the cost is flat: a part √(1e-10) of the standard error, its rule for having converged.
  const auto near = [&](const Estimate& x, const Estimate& y, double factor) {
    RC_ASSERT(x.value.has_value() == y.value.has_value());
    if (!x.value) return;
    RC_ASSERT(std::abs(*x.value * factor - *y.value) <= 1e-4 * x.standard_error.value_or(0.0) * factor);
  };
  near(a.results.mu_s, b.results.mu_s, gain);
  near(a.results.mu_k, b.results.mu_k, gain);
  near(a.results.delta_mu, b.results.delta_mu, gain);
  near(a.results.omega, b.results.omega, 1.0);
  near(a.results.gamma_over_2omega, b.results.gamma_over_2omega, 1.0);
  near(a.results.Q, b.results.Q, 1.0);
  near(a.results.transition_time, b.results.transition_time, 1.0);
}

void assert_answered(const Analysed& analysed) {
  RC_ASSERT(!analysed.results.regime_reason.empty());
  for_each_result(analysed.results, [](const ResultName& name, const Estimate& estimate) {
    const std::string which{name.name};
    if (estimate.value.has_value() != estimate.reason.empty()) RC_FAIL(which + ": value and reason disagree");
    if (estimate.value && !std::isfinite(*estimate.value)) RC_FAIL(which + " is not finite");
    for (const auto& error : {estimate.standard_error, estimate.systematic_uncertainty}) {
      if (error && !(std::isfinite(*error) && *error >= 0.0)) RC_FAIL(which + ": error is not a size");
    }
  });
}

enum class Kind {
  kConstant,
  kOneStepNoise,
  kSaturated,
  kThreeSteps,
  kWhite,
  kWalk,
  kSquare,
  kSpikesOnly,
  kCount
};

/// Signals with nothing to find, of any length from no scan on.
Input any_poor_signal(std::size_t most) {
  const auto kind = static_cast<Kind>(*rc::gen::inRange(0, static_cast<int>(Kind::kCount)));
  const auto length = *rc::gen::inRange<std::size_t>(0, most);
  const double scale = std::pow(10.0, *rc::gen::inRange(-6, 7));
  const double offset = *rc::gen::element(0.0, 0.3, -0.3, 1e6) * scale;
  const double step = scale / 65536.0;
  const int period = *rc::gen::inRange(2, 40);
  std::mt19937_64 engine{*rc::gen::arbitrary<std::uint32_t>()};
  std::normal_distribution<double> normal;
  Input input;
  input.settings.step_coefficient = *rc::gen::element(0.0, step);
  double walk = 0.0;
  for (std::size_t k = 0; k < length; ++k) {
    const bool high = (k / static_cast<std::size_t>(period)) % 2 == 1;
    walk += normal(engine);
    double value = 0.0;
    bool rail = false;
    switch (kind) {
      case Kind::kConstant:
        break;
      case Kind::kOneStepNoise:
        value = step * static_cast<double>(engine() % 2);
        break;
      case Kind::kSaturated:
        value = high ? scale : -scale;
        rail = true;
        break;
      case Kind::kThreeSteps:
        value = step * std::round(1.5 * std::sin(static_cast<double>(k) / period));
        break;
      case Kind::kWhite:
        value = scale * normal(engine);
        break;
      case Kind::kWalk:
        value = scale * walk;
        break;
      case Kind::kSquare:
        value = high ? scale : 0.0;
        break;
      case Kind::kSpikesOnly:
        value = engine() % 15 == 0 ? scale : 0.0;
        break;
      case Kind::kCount:
        break;
    }
    input.values.push_back(offset + value);
    input.saturated.push_back(rail);
  }
  return input;
}

RC_GTEST_PROP(AnalysisProperty, PoorSignalGetsAnAnswerWithReasons, ()) {
  assert_answered(analyse(any_poor_signal(1500)));
}

RC_GTEST_PROP(AnalysisProperty, FewScansGetAnAnswerWithReasons, ()) {
  assert_answered(analyse(any_poor_signal(80)));
}

RC_GTEST_PROP(AnalysisProperty, TestGetsAnAnswerWhereverItIsCut, ()) {
  Input input = any_test();
  input.values.resize(*rc::gen::inRange<std::size_t>(0, input.values.size() + 1));
  assert_answered(analyse(input));
}

// Gaps of any length anywhere, told by gap() and seen as a jump of the index.
RC_GTEST_PROP(AnalysisProperty, TestWithGapsGetsAnAnswerThatCountsThem, ()) {
  const Input input = any_test();
  const auto gaps = *rc::gen::inRange<std::size_t>(0, 4);
  std::vector<std::size_t> before;
  before.reserve(gaps);
  for (std::size_t i = 0; i < gaps; ++i)
    before.push_back(*rc::gen::inRange<std::size_t>(1, input.values.size()));
  std::sort(before.begin(), before.end());
  before.erase(std::unique(before.begin(), before.end()), before.end());
  const auto length = *rc::gen::element<base::ScanIndex>(1, 10, 1000);
  TestAnalysis analysis{input.settings};
  base::ScanIndex index = 0;
  for (std::size_t k = 0; k < input.values.size(); ++k) {
    if (std::find(before.begin(), before.end(), k) != before.end()) {
      analysis.gap(index, length);
      index += length;
    }
    analysis.add(index++, input.values[k], false);
  }
  Analysed analysed;
  analysed.results = analysis.finish();
  assert_answered(analysed);
  RC_ASSERT(analysed.results.gap_count.value == static_cast<double>(before.size()));
  RC_ASSERT(analysed.results.lost_scan_count.value ==
            static_cast<double>(length * static_cast<base::ScanIndex>(before.size())));
}

TEST(Analysis, ConstantSignalSlidesSteadily) {
  const Analysed analysed = analyse({std::vector<double>(1000, 0.3), {}, {}});
  EXPECT_EQ(analysed.results.regime, model::Regime::kSteadySliding);
  EXPECT_EQ(analysed.results.cycle_count.value, 0.0);
  EXPECT_NEAR(analysed.results.kinetic_coefficient.value.value(), 0.3, 1e-15);
}

// Below 68 scans the noise is not known, so that noise itself could make "slips": such a stub gets a reason.
TEST(Analysis, FewerScansThanTheNoiseNeedsAreUndecided) {
  std::mt19937_64 engine{1};
  std::normal_distribution<double> normal{0.3, 0.001};
  Input input;
  while (input.values.size() < signal::kFewestScansForNoise) {
    const TestResults results = analyse(input).results;
    EXPECT_EQ(results.regime, model::Regime::kUndecided);
    EXPECT_EQ(results.regime_reason,
              std::to_string(input.values.size()) + " scans, 68 are needed to know their noise");
    EXPECT_FALSE(results.cycle_count.value);
    input.values.push_back(normal(engine));
  }
  EXPECT_EQ(analyse(input).results.regime, model::Regime::kSteadySliding);
}

TEST(Analysis, NoiseOfOneStepHasNoSlips) {
  Input input;
  input.settings.step_coefficient = 1e-4;
  std::mt19937_64 engine{1};
  for (int k = 0; k < 100'000; ++k) input.values.push_back(0.3 + 1e-4 * static_cast<double>(engine() % 2));
  EXPECT_EQ(analyse(input).results.cycle_count.value, 0.0);
}

}  // namespace
}  // namespace stickslip::analysis

#include "core/sim/transducer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "core/sim/propagator.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"
#include "tests/support/allocation_count.hpp"

namespace stickslip::sim {
namespace {

using model::AntiAlias;
using model::LoadCellDynamics;
using model::Oscillator;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kRate_Hz = 350.0;
const std::filesystem::path kScenes = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config" / "scenes";

Scene stick_slip() { return *load_scene(kScenes / "stick-slip-at-12-in-per-min.toml"); }

/// A force cos(ωt) that has always been slipping, a scan period at a time.
ForceStretch cosine(double omega, std::size_t scan) {
  const double angle = omega * static_cast<double>(scan) / kRate_Hz;
  return {1.0 / kRate_Hz, {}, std::cos(angle), -omega * std::sin(angle)};
}

// τy′ + y = rt: y = r (t − τ + τ e^(−t/τ)). Some ten operations a scan, on numbers up to 10: 1e-13.
TEST(Transducer, RcFilterFollowsALineExactly) {
  const double cutoff_Hz = 3.0;
  const double tau_s = 1.0 / (2.0 * kPi * cutoff_Hz);
  Transducer filter{{}, AntiAlias{cutoff_Hz, 1}, Oscillator::from_omega(125.0, 0.02), kRate_Hz};
  for (int scan = 0; scan < 3500; ++scan) {
    const double t_s = scan / kRate_Hz;
    EXPECT_NEAR(filter.output(), t_s - tau_s + tau_s * std::exp(-t_s / tau_s), 1e-13) << scan;
    ExponentialPolynomial line{t_s};
    line.add_power(1, 1.0);
    filter.follow({1.0 / kRate_Hz, line});
  }
}

// The force at the cell's own frequency, where a particular solution would divide by almost nothing:
// y = (sin ωt − e^(−ζωt) sin(ω√(1−ζ²) t)/√(1−ζ²))/2ζ. The two parts cancel: 1/2ζ = 5e5 times the
// rounding of angles up to 1257 (1e-13).
TEST(Transducer, LoadCellInResonanceIsNoSpecialCase) {
  const double omega = 2.0 * kPi * 20.0;
  for (const double zeta : {0.3, 0.01, 1e-6}) {
    Transducer cell{LoadCellDynamics{20.0, zeta}, {}, Oscillator::from_omega0(omega * omega, 0.0), kRate_Hz};
    for (std::size_t scan = 0; scan < 3500; ++scan) {
      const double t_s = static_cast<double>(scan) / kRate_Hz;
      const double root = std::sqrt(1.0 - zeta * zeta);
      const double expected =
          (std::sin(omega * t_s) - std::exp(-zeta * omega * t_s) * std::sin(omega * root * t_s) / root) /
          (2.0 * zeta);
      EXPECT_NEAR(cell.output(), expected, 1e-11 + 5e-13 / zeta) << zeta << " " << scan;
      cell.follow(cosine(omega, scan));
    }
  }
}

// |H|² = 1/(1 + (f/f_c)^(2n)). After 10 s the slowest pole, sin(π/16) · 2π · 10 Hz, has died out (e^(−122));
// two readings a quarter period apart give the amplitude. Both lie within 1e-13 of their place.
TEST(Transducer, ButterworthHasItsGainAtEveryOrder) {
  for (int order = 1; order <= AntiAlias::kHighestOrder; ++order) {
    for (const double frequency_Hz : {5.0, 10.0, 17.5, 35.0}) {
      const double omega = 2.0 * kPi * frequency_Hz;
      Transducer filter{{}, AntiAlias{10.0, order}, Oscillator::from_omega0(omega * omega, 0.0), kRate_Hz};
      for (std::size_t scan = 0; scan < 3500; ++scan) filter.follow(cosine(omega, scan));
      const double first = filter.output();
      ForceStretch quarter = cosine(omega, 3500);
      quarter.duration_s = 0.25 / frequency_Hz;
      filter.follow(quarter);
      const double gain = std::hypot(first, filter.output());
      EXPECT_NEAR(gain, 1.0 / std::sqrt(1.0 + std::pow(frequency_Hz / 10.0, 2.0 * order)), 1e-12)
          << order << " " << frequency_Hz;
    }
  }
}

// Exact means that it does not matter how often one looks. Event times round at 1e-16 of a scan period and
// the signal is 1; ten thousand roundings that the filter forgets again leave 1e-12.
TEST(Transducer, ReadingsDoNotDependOnTheScanRate) {
  Scene scene = stick_slip();
  scene.white_noise.reset();
  scene.quantisation.reset();
  scene.load_cell_dynamics = LoadCellDynamics{250.0, 0.02};
  scene.anti_alias = AntiAlias{100.0, 4};
  std::vector<double> slow(2800);
  SceneRun{scene, kRate_Hz}.next(slow);
  for (const std::size_t times : {2U, 16U}) {
    std::vector<double> fast(2800 * times);
    SceneRun{scene, kRate_Hz * static_cast<double>(times)}.next(fast);
    for (std::size_t i = 0; i < slow.size(); ++i) {
      EXPECT_NEAR(slow[i], fast[i * times], 1e-11) << i;  // In volts, up to 4.
    }
  }
}

// The whole test – idle, stick and slip, stop, return, slack – beside the same filter on straight lines
// between 64 times as many points: off by at most max|c″| h²/8 = ω₀² · 0.1 · h²/8 = 4e-7.
TEST(Transducer, FollowsEveryPieceOfTheMotion) {
  constexpr std::size_t kTimes = 64;
  const double h_s = 1.0 / (kRate_Hz * kTimes);
  const double tau_s = 1.0 / (2.0 * kPi * 30.0);
  const Scene scene = stick_slip();
  Propagator dense{motion_of(scene), 1.0 / h_s};
  std::vector<double> force(2800 * kTimes + 1);
  dense.next(force);

  Propagator sled{motion_of(scene), kRate_Hz};
  Transducer filter{{}, AntiAlias{30.0, 1}, scene.oscillator, kRate_Hz};
  const double decay = std::exp(-h_s / tau_s);
  double y = 0.0;
  for (std::size_t i = 0; i < 2800 * kTimes; ++i) {
    if (i % kTimes == 0) {
      sled.follow_to({static_cast<std::int64_t>(i / kTimes), 0.0}, filter);
      EXPECT_NEAR(filter.output(), y, 1e-6) << i / kTimes;
    }
    const double slope = (force[i + 1] - force[i]) / h_s;
    y = decay * y + (1.0 - decay) * (force[i] - slope * tau_s) + slope * h_s;
  }
}

// The same for a belt that changes its speed and K that drifts: polynomials, decays and oscillations.
TEST(Transducer, FollowsCourses) {
  constexpr std::size_t kTimes = 64;
  constexpr std::size_t kScans = 1000;
  const double h_s = 1.0 / (kRate_Hz * kTimes);
  const double tau_s = 1.0 / (2.0 * kPi * 30.0);
  Scene scene = stick_slip();
  scene.exponential_start = ExponentialStart{0.3};
  scene.kinetic_drift = KineticDrift{KineticDrift::Form::kExponential, KineticDrift::Over::kTime, 0.4, 2.0};
  Propagator dense{motion_of(scene), 1.0 / h_s};
  std::vector<double> force(kScans * kTimes + 1);
  dense.next(force);

  Propagator sled{motion_of(scene), kRate_Hz};
  Transducer filter{{}, AntiAlias{30.0, 1}, scene.oscillator, kRate_Hz};
  const double decay = std::exp(-h_s / tau_s);
  double y = 0.0;
  for (std::size_t i = 0; i < kScans * kTimes; ++i) {
    if (i % kTimes == 0) {
      sled.follow_to({static_cast<std::int64_t>(i / kTimes), 0.0}, filter);
      ASSERT_NEAR(filter.output(), y, 1e-6) << i / kTimes;
    }
    const double slope = (force[i + 1] - force[i]) / h_s;
    y = decay * y + (1.0 - decay) * (force[i] - slope * tau_s) + slope * h_s;
  }
}

// τy′ + y = t³ from rest: y = t³ − 3τt² + 6τ²t − 6τ³(1 − e^(−t/τ)), in stretches that start anew each time.
TEST(Transducer, FollowsACubicGivenPieceByPiece) {
  const double tau_s = 0.05;
  const double duration_s = 0.0123;  // Not the scan period.
  Transducer filter{
      {}, AntiAlias{1.0 / (2.0 * kPi * tau_s), 1}, Oscillator::from_omega(125.0, 0.02), kRate_Hz};
  for (int piece = 0; piece < 80; ++piece) {
    const double t_s = piece * duration_s;
    const double expected = t_s * t_s * t_s - 3.0 * tau_s * t_s * t_s + 6.0 * tau_s * tau_s * t_s +
                            6.0 * tau_s * tau_s * tau_s * std::expm1(-t_s / tau_s);
    // Eighty pieces with some roundings of numbers up to 1 each.
    ASSERT_NEAR(filter.output(), expected, 1e-13) << piece;
    ForceStretch stretch{duration_s, ExponentialPolynomial{t_s * t_s * t_s}};
    stretch.course.add_power(1, 3.0 * t_s * t_s);
    stretch.course.add_power(2, 3.0 * t_s);
    stretch.course.add_power(3, 1.0);
    filter.follow(stretch);
  }
}

// τy′ + y = φ₂(λ, t), also at λ = 1/τ, where a particular solution would divide by nothing: a tiny step of
// the same equation by its own matrix exponential would not show a wrong start, so Simpson's rule does:
// y = ∫ e^(−(t−s)/τ) φ₂(s) ds/τ, off by h⁴/180 of its fourth derivative: (20/s)⁴ (5e-4 s)⁴/180 = 6e-11 of 1.
TEST(Transducer, FollowsDecaysAlsoInResonance) {
  const double tau_s = 0.05;
  for (const double rate : {0.3, 20.0, 45.0}) {
    Transducer filter{
        {}, AntiAlias{1.0 / (2.0 * kPi * tau_s), 1}, Oscillator::from_omega(125.0, 0.02), kRate_Hz};
    ExponentialPolynomial course{0.2};
    course.add_decay(rate, 2, 1.5);
    course.add_decay(rate, 0, -0.3);
    course.add_decay(7.0, 1, 2.0);
    filter.follow({0.1, course});
    filter.follow({0.2, course.later(0.1)});
    constexpr int kSteps = 600;
    const double h_s = 0.3 / kSteps;
    double expected = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
      const double weight = i == 0 || i == kSteps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
      expected += weight * h_s / 3.0 * std::exp(-(0.3 - i * h_s) / tau_s) / tau_s * course.value(i * h_s);
    }
    EXPECT_NEAR(filter.output(), expected, 1e-9) << rate;
  }
}

// Instants between scans, as jitter asks for them, are instants of a faster clock.
TEST(Transducer, AnswersAtAnyInstant) {
  const Scene scene = stick_slip();
  const LoadCellDynamics cell{150.0, 0.1};
  Propagator fast{motion_of(scene), 3.0 * kRate_Hz};
  Transducer fast_cell{cell, {}, scene.oscillator, 3.0 * kRate_Hz};
  Propagator sled{motion_of(scene), kRate_Hz};
  Transducer slow_cell{cell, {}, scene.oscillator, kRate_Hz};
  for (std::int64_t i = 0; i < 3 * 2800; i += 1 + i % 4) {
    fast.follow_to({i, 0.0}, fast_cell);
    sled.follow_to({i / 3, static_cast<double>(i % 3) / 3.0}, slow_cell);
    EXPECT_NEAR(slow_cell.output(), fast_cell.output(), 1e-11) << i;
  }
}

const std::string kScene = R"(description = "d"
duration = "1 s"
[tester]
sled_mass = "2331 g"
frequency = "20 Hz"
load_cell_gain = "2 N/V"
[paper]
mu_s = 0.35
mu_k = 0.30
)";

std::string refusal(const std::string& effect) {
  const base::Result<Scene> scene = parse_scene(kScene + effect, "test.toml");
  return scene ? "" : scene.error().message;
}

TEST(TransducerStage, MistakesAreNamedWithPlaceValueAndLimit) {
  const std::string filter = "[effects.anti_alias]\n";
  EXPECT_EQ(refusal(filter + "cutoff = \"100 Hz\"\nkind = \"rc\"\n"), "");
  EXPECT_THAT(refusal(filter + "cutoff = \"200 Hz\"\nkind = \"rc\"\n"),
              AllOf(HasSubstr("test.toml:11"), HasSubstr("200 Hz"), HasSubstr("at most 175 Hz")));
  EXPECT_THAT(refusal(filter + "cutoff = \"100 Hz\"\nkind = \"rc\"\norder = 2\n"),
              AllOf(HasSubstr("test.toml:13"), HasSubstr("order")));
  EXPECT_THAT(refusal(filter + "cutoff = \"100 Hz\"\nkind = \"butterworth\"\norder = 9\n"),
              AllOf(HasSubstr("test.toml:13"), HasSubstr("from 1 to 8")));
  EXPECT_THAT(refusal(filter + "cutoff = \"100 Hz\"\nkind = \"brickwall\"\n"),
              AllOf(HasSubstr("test.toml:12"), HasSubstr("butterworth")));
  EXPECT_THAT(refusal("[effects.load_cell]\nfrequency = \"300 Hz\"\ndamping_ratio = 0\n"),
              AllOf(HasSubstr("test.toml:12"), HasSubstr("above 0")));
}

TEST(TransducerStage, ComesBetweenMotionAndSampling) {
  Scene scene = *parse_scene(
      kScene + "[effects.clock_jitter]\nsd = \"1 us\"\n[effects.damping]\ngamma_over_2omega = 0.02\n",
      "t.toml");
  EXPECT_THAT((SceneRun{scene, kRate_Hz}.effects()), ElementsAre("damping", "clock_jitter"));
  scene.anti_alias = AntiAlias{100.0, 2};
  scene.load_cell_dynamics = LoadCellDynamics{300.0, 0.05};
  EXPECT_THAT((SceneRun{scene, kRate_Hz}.effects()),
              ElementsAre("damping", "load_cell", "anti_alias", "clock_jitter"));
}

TEST(TransducerStage, DoesNotAllocate) {
  Scene scene = stick_slip();
  scene.load_cell_dynamics = LoadCellDynamics{300.0, 0.05};
  scene.anti_alias = AntiAlias{100.0, AntiAlias::kHighestOrder};
  scene.clock_jitter = ClockJitter{1e-5};
  scene.exponential_start = ExponentialStart{0.3};
  scene.kinetic_drift = KineticDrift{KineticDrift::Form::kExponential, KineticDrift::Over::kTime, 0.4, 2.0};
  SceneRun run{scene, kRate_Hz};
  std::vector<double> raw(64);
  const std::uint64_t before = test::allocation_count();
  while (run.next(raw) > 0) {
  }
  run.restart(7);
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(TransducerStage, ShippedSceneShowsAllOfIt) {
  const base::Result<Scene> scene = load_scene(kScenes / "load-cell-and-anti-alias-filter.toml");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT((SceneRun{*scene, kRate_Hz}.effects()), ::testing::IsSupersetOf({"load_cell", "anti_alias"}));
}

}  // namespace
}  // namespace stickslip::sim

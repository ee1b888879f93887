// An effect that is not listed is not built and not called. The program is the shipped library; the
// linker (--wrap, see CMakeLists.txt) puts a counter in front of each function that builds an effect or
// is called for one, so that nothing of it stands in what is shipped.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/sim/clock_jitter.hpp"
#include "core/sim/missing_scans.hpp"
#include "core/sim/motion_solver.hpp"
#include "core/sim/paper.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/signal_effect.hpp"
#include "core/sim/transducer.hpp"
#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

struct Count {
  std::int64_t built = 0;
  std::int64_t calls = 0;       ///< To make scans; restart() does not count.
  std::int64_t scans = 0;       ///< That were handed to the effect, where it is handed scans.
  std::vector<double> numbers;  ///< What the effect drew, whatever the others made of it.
};

/// By the effect's name; "transducer" and "motion" are the stages.
std::map<std::string, Count>& counts() {
  static std::map<std::string, Count> all;
  return all;
}

/// Adds the same numbers to the readings, and shows them.
class CountedSignal final : public SignalEffect {
 public:
  explicit CountedSignal(std::unique_ptr<SignalEffect> effect) : effect_(std::move(effect)) {
    ++count().built;
  }

  [[nodiscard]] std::string_view name() const noexcept override { return effect_->name(); }
  void restart(std::uint64_t seed) override { effect_->restart(seed); }
  void apply(std::span<double> reading) override {
    ++count().calls;
    count().scans += static_cast<std::int64_t>(reading.size());
    if (name() == "quantisation") return effect_->apply(reading);
    std::vector<double> alone(reading.size(), 0.0);
    effect_->apply(alone);
    for (std::size_t i = 0; i < alone.size(); ++i) reading[i] += alone[i];
    count().numbers.insert(count().numbers.end(), alone.begin(), alone.end());
  }

 private:
  [[nodiscard]] Count& count() const { return counts()[std::string{effect_->name()}]; }

  std::unique_ptr<SignalEffect> effect_;
};

class CountedPaper final : public PaperEffect {
 public:
  explicit CountedPaper(std::unique_ptr<PaperEffect> effect) : effect_(std::move(effect)) { ++count().built; }

  [[nodiscard]] std::string_view name() const noexcept override { return effect_->name(); }
  void restart(std::uint64_t seed) override {
    effect_->restart(seed);
    count().numbers.clear();  // The solver restarts itself once before the run does.
  }
  void renew(Coefficients& contact) override {
    ++count().calls;
    Coefficients alone{0.35, 0.30};
    effect_->renew(alone);
    contact.mu_s += alone.mu_s - 0.35;
    contact.mu_k += alone.mu_k - 0.30;
    contact.mu_s = std::max(contact.mu_s, contact.mu_k);
    count().numbers.push_back(alone.mu_s);
    count().numbers.push_back(alone.mu_k);
  }
  void slipped() override { effect_->slipped(); }

 private:
  [[nodiscard]] Count& count() const { return counts()[std::string{effect_->name()}]; }

  std::unique_ptr<PaperEffect> effect_;
};

class CountedMotion final : public MotionSolver {
 public:
  explicit CountedMotion(std::unique_ptr<MotionSolver> solver) : solver_(std::move(solver)) {
    ++counts()["motion"].built;
  }

  void restart(std::uint64_t seed) override { solver_->restart(seed); }
  void next(std::span<double> coefficient) override {
    ++counts()["motion"].calls;
    solver_->next(coefficient);
  }
  [[nodiscard]] double at(const ScanTime& instant) override {
    ++counts()["motion.at"].calls;
    return solver_->at(instant);
  }
  void follow_to(const ScanTime& instant, ForceFollower& follower) override {
    ++counts()["transducer"].calls;
    solver_->follow_to(instant, follower);
  }
  void skip(std::int64_t scans) override { solver_->skip(scans); }
  [[nodiscard]] SolverMethod method() const override { return solver_->method(); }

 private:
  std::unique_ptr<MotionSolver> solver_;
};

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier): these names are the linker's.
#define STICKSLIP_REAL(name) asm("__real_" name)
#define STICKSLIP_WRAP(name) asm("__wrap_" name)

#define STICKSLIP_COUNT_FACTORY(Base, Counted, Settings, factory, symbol)          \
  std::unique_ptr<Base> real_##factory(const Settings&) STICKSLIP_REAL(symbol);    \
  std::unique_ptr<Base> wrapped_##factory(const Settings&) STICKSLIP_WRAP(symbol); \
  std::unique_ptr<Base> wrapped_##factory(const Settings& settings) {              \
    return std::make_unique<Counted>(real_##factory(settings));                    \
  }
#define STICKSLIP_COUNT_TIMED_FACTORY(Settings, factory, symbol)                                   \
  std::unique_ptr<SignalEffect> real_##factory(const Settings&, double) STICKSLIP_REAL(symbol);    \
  std::unique_ptr<SignalEffect> wrapped_##factory(const Settings&, double) STICKSLIP_WRAP(symbol); \
  std::unique_ptr<SignalEffect> wrapped_##factory(const Settings& settings, double rate_Hz) {      \
    return std::make_unique<CountedSignal>(real_##factory(settings, rate_Hz));                     \
  }

STICKSLIP_COUNT_FACTORY(SignalEffect, CountedSignal, WhiteNoise, white_noise,
                        "_ZN9stickslip3sim16make_white_noiseERKNS0_10WhiteNoiseE")
STICKSLIP_COUNT_FACTORY(SignalEffect, CountedSignal, Quantisation, quantisation,
                        "_ZN9stickslip3sim17make_quantisationERKNS0_12QuantisationE")
STICKSLIP_COUNT_TIMED_FACTORY(DriftNoise, drift_noise,
                              "_ZN9stickslip3sim16make_drift_noiseERKNS0_10DriftNoiseEd")
STICKSLIP_COUNT_TIMED_FACTORY(MainsHum, mains_hum, "_ZN9stickslip3sim14make_mains_humERKNS0_8MainsHumEd")
STICKSLIP_COUNT_TIMED_FACTORY(Spikes, spikes, "_ZN9stickslip3sim11make_spikesERKNS0_6SpikesEd")
STICKSLIP_COUNT_FACTORY(PaperEffect, CountedPaper, Scatter, scatter,
                        "_ZN9stickslip3sim12make_scatterERKNS0_7ScatterE")
STICKSLIP_COUNT_FACTORY(PaperEffect, CountedPaper, FirstPeak, first_peak,
                        "_ZN9stickslip3sim15make_first_peakERKNS0_9FirstPeakE")

std::unique_ptr<MotionSolver> real_solver(const Motion&, double, double, MotionObserver*, std::uint64_t)
    STICKSLIP_REAL("_ZN9stickslip3sim18make_motion_solverERKNS0_6MotionEddPNS0_14MotionObserverEm");
std::unique_ptr<MotionSolver> wrapped_solver(const Motion&, double, double, MotionObserver*, std::uint64_t)
    STICKSLIP_WRAP("_ZN9stickslip3sim18make_motion_solverERKNS0_6MotionEddPNS0_14MotionObserverEm");
std::unique_ptr<MotionSolver> wrapped_solver(const Motion& motion, double scan_rate_Hz, double accuracy,
                                             MotionObserver* observer, std::uint64_t seed) {
  return std::make_unique<CountedMotion>(real_solver(motion, scan_rate_Hz, accuracy, observer, seed));
}

// Members: `this` is the first argument of the Itanium ABI, which GCC and Clang follow.

using LoadCellOption = std::optional<model::LoadCellDynamics>;
using FilterOption = std::optional<model::AntiAlias>;
#define STICKSLIP_TRANSDUCER                                                                                \
  "_ZN9stickslip3sim10TransducerC1ERKSt8optionalINS_5model16LoadCellDynamicsEERKS2_INS3_9AntiAliasEERKNS3_" \
  "10OscillatorEd"
void real_transducer(Transducer*, const LoadCellOption&, const FilterOption&, const model::Oscillator&,
                     double) STICKSLIP_REAL(STICKSLIP_TRANSDUCER);
void wrapped_transducer(Transducer*, const LoadCellOption&, const FilterOption&, const model::Oscillator&,
                        double) STICKSLIP_WRAP(STICKSLIP_TRANSDUCER);
void wrapped_transducer(Transducer* self, const LoadCellOption& load_cell, const FilterOption& anti_alias,
                        const model::Oscillator& oscillator, double rate_Hz) {
  ++counts()["transducer"].built;
  if (load_cell) ++counts()["load_cell"].built;
  if (anti_alias) ++counts()["anti_alias"].built;
  real_transducer(self, load_cell, anti_alias, oscillator, rate_Hz);
}

#define STICKSLIP_JITTER_RESTART "_ZN9stickslip3sim14JitteringClock7restartEm"
void real_jitter_restart(JitteringClock*, std::uint64_t) STICKSLIP_REAL(STICKSLIP_JITTER_RESTART);
void wrapped_jitter_restart(JitteringClock*, std::uint64_t) STICKSLIP_WRAP(STICKSLIP_JITTER_RESTART);
void wrapped_jitter_restart(JitteringClock* self, std::uint64_t seed) {
  ++counts()["clock_jitter"].built;  // Its constructor is inline; a run restarts what it has built.
  real_jitter_restart(self, seed);
}

#define STICKSLIP_JITTER_INSTANT "_ZN9stickslip3sim14JitteringClock7instantEl"
ScanTime real_jitter_instant(JitteringClock*, std::int64_t) STICKSLIP_REAL(STICKSLIP_JITTER_INSTANT);
ScanTime wrapped_jitter_instant(JitteringClock*, std::int64_t) STICKSLIP_WRAP(STICKSLIP_JITTER_INSTANT);
ScanTime wrapped_jitter_instant(JitteringClock* self, std::int64_t scan) {
  const ScanTime instant = real_jitter_instant(self, scan);
  Count& count = counts()["clock_jitter"];
  ++count.calls;
  count.numbers.push_back(instant.periods_since({scan, 0.0}));
  return instant;
}

#define STICKSLIP_MISSING_RESTART "_ZN9stickslip3sim13MissingBursts7restartEm"
void real_missing_restart(MissingBursts*, std::uint64_t) STICKSLIP_REAL(STICKSLIP_MISSING_RESTART);
void wrapped_missing_restart(MissingBursts*, std::uint64_t) STICKSLIP_WRAP(STICKSLIP_MISSING_RESTART);
void wrapped_missing_restart(MissingBursts* self, std::uint64_t seed) {
  ++counts()["missing_scans"].built;
  real_missing_restart(self, seed);
}

#define STICKSLIP_MISSING_NEXT "_ZN9stickslip3sim13MissingBursts4nextEv"
void real_missing_next(MissingBursts*) STICKSLIP_REAL(STICKSLIP_MISSING_NEXT);
void wrapped_missing_next(MissingBursts*) STICKSLIP_WRAP(STICKSLIP_MISSING_NEXT);
void wrapped_missing_next(MissingBursts* self) {
  real_missing_next(self);
  Count& count = counts()["missing_scans"];
  ++count.calls;
  count.numbers.push_back(static_cast<double>(self->first()));
  count.numbers.push_back(static_cast<double>(self->end()));
}

#define STICKSLIP_AGEING_GROWTH "_ZNK9stickslip3sim13ContactAgeing6growthEd"
double real_ageing_growth(const ContactAgeing*, double) STICKSLIP_REAL(STICKSLIP_AGEING_GROWTH);
double wrapped_ageing_growth(const ContactAgeing*, double) STICKSLIP_WRAP(STICKSLIP_AGEING_GROWTH);
double wrapped_ageing_growth(const ContactAgeing* self, double rested_s) {
  ++counts()["contact_ageing"].calls;
  return real_ageing_growth(self, rested_s);
}
// NOLINTEND(bugprone-reserved-identifier)

namespace {

constexpr double kRate_Hz = 350.0;

/// Every effect that has code of its own, as a scene lists it.
const std::vector<std::pair<std::string, std::string>>& effects() {
  static const std::vector<std::pair<std::string, std::string>> kEffects{
      {"scatter", "[effects.scatter]\ndelta_mu_cv = 0.3\nmu_k_sd = 0.01\n"},
      {"first_peak", "[effects.first_peak]\nchange = 0.02\nsd = 0.01\n"},
      {"contact_ageing", "[effects.contact_ageing]\nper_decade = 0.01\n"},
      {"load_cell", "[effects.load_cell]\nfrequency = \"300 Hz\"\ndamping_ratio = 0.02\n"},
      {"anti_alias", "[effects.anti_alias]\nkind = \"butterworth\"\ncutoff = \"100 Hz\"\norder = 4\n"},
      {"clock_jitter", "[effects.clock_jitter]\nsd = \"50 us\"\n"},
      {"missing_scans", "[effects.missing_scans]\nrate = \"5 1/s\"\nmean_length = 3\n"},
      {"white_noise", "[effects.white_noise]\nsd = 0.001\n"},
      {"drift_noise", "[effects.drift_noise]\nsd = 0.001\n"},
      {"mains_hum", "[effects.mains_hum]\nfrequency = \"60 Hz\"\namplitude = 0.002\n"},
      {"spikes", "[effects.spikes]\nrate = \"5 1/s\"\nmean_size = 0.1\n"},
      {"quantisation", "[effects.quantisation]\nbits = 16\nrange_min = \"-10 V\"\nrange_max = \"10 V\"\n"},
  };
  return kEffects;
}

/// A pull that sticks and slips for 4 s of 5.
std::string pull() {
  std::string text = scene_at_rest();
  text.erase(text.find("duration"), std::string("duration = \"1 s\"\n").size());
  return text +
         "[effects.damping]\ngamma_over_2omega = 0.022\n"
         "[effects.constant_speed]\nidle = \"0.1 s\"\npull_speed = \"0.5 mm/s\"\npull = \"4 s\"\nstop = "
         "\"0.5 s\"\n"
         "return_speed = \"10 mm/s\"\nreturn = \"0.3 s\"\nrest = \"0.1 s\"\n";
}

/// What a scene with these effects builds and calls, all scans of it.
std::map<std::string, Count> play(const std::string& listed) {
  const Scene scene = scene_of(pull() + listed);
  counts().clear();
  SceneRun run{scene, kRate_Hz};
  std::array<double, 64> raw{};
  while (run.next(raw) > 0) {
  }
  return counts();
}

std::int64_t scan_count() { return sim::scan_count(scene_of(pull()), kRate_Hz); }

TEST(CountedStages, WithoutEffectsThereIsTheMotionAndNothingElse) {
  const auto counted = play("");
  ASSERT_EQ(counted.size(), 1U) << counted.begin()->first;
  EXPECT_EQ(counted.at("motion").built, 1);
}

TEST(CountedStages, WhatIsListedIsBuiltOnceAndCalledAndNothingElseIs) {
  for (const auto& [name, text] : effects()) {
    SCOPED_TRACE(name);
    auto counted = play(text);
    const bool transducer = name == "load_cell" || name == "anti_alias";
    for (const auto& [other, unused] : effects()) {
      SCOPED_TRACE(other);
      if (other == name) continue;
      EXPECT_EQ(counted[other].built, 0);
      EXPECT_EQ(counted[other].calls, 0);
    }
    EXPECT_EQ(counted["motion"].built, 1);
    EXPECT_EQ(counted["transducer"].built, transducer ? 1 : 0);
    // Every scan is asked for once, in the one way that the effects need.
    EXPECT_EQ(counted["transducer"].calls, transducer ? scan_count() : 0);
    EXPECT_EQ(counted["motion.at"].calls, name == "clock_jitter" ? scan_count() : 0);
    EXPECT_EQ(counted["motion"].calls > 0, !transducer && name != "clock_jitter");
    // The contact's age is part of a formula, not an object.
    if (name != "contact_ageing") {
      EXPECT_EQ(counted[name].built, 1);
    }
    if (!transducer) {
      EXPECT_GT(counted[name].calls, 0);
    }
    if (name == "clock_jitter") {
      EXPECT_EQ(counted[name].calls, scan_count());
    }
    if (counted[name].scans > 0) {
      EXPECT_EQ(counted[name].scans, scan_count());
    }
  }
}

// Two effects may change the motion, and so how often a third is asked; what it answers stays the same.
TEST(CountedStages, NoEffectChangesTheNumbersOfAnother) {
  for (const auto& [name, text] : effects()) {
    const std::vector<double> alone = play(text)[name].numbers;
    if (alone.empty()) continue;  // It draws none.
    for (const auto& [other, other_text] : effects()) {
      if (other == name) continue;
      SCOPED_TRACE(fmt::format("{} with {}", name, other));
      const std::vector<double> with = play(text + other_text)[name].numbers;
      const std::size_t common = std::min(alone.size(), with.size());
      ASSERT_GT(common, 0U);
      EXPECT_TRUE(
          std::equal(alone.begin(), alone.begin() + static_cast<std::ptrdiff_t>(common), with.begin()));
    }
  }
}

}  // namespace
}  // namespace stickslip::sim

#include "core/analysis/transducer_correction.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/model/slip_model.hpp"
#include "core/model/turned_basis.hpp"

namespace stickslip::analysis {

using Column = base::LongColumn<double>;

namespace {

/// Between slips farther apart than this the transducer has come to rest on the rise.
constexpr double kFarthest_s = 1.0;
/// Largest phase of the slip's oscillation in a step: a straight line within it is off by 5e-5 of S - K.
constexpr double kSlipPhase_rad = 0.02;
/// Largest phase of a transducer's oscillation in a step, which one section of it hands to the next as
/// straight lines.
constexpr double kTransducerPhase_rad = 0.1;
/// Most steps of a scan interval. A transducer so fast that it would need more adds next to nothing.
constexpr double kMostSteps = 64.0;

/// Step of the response, a whole part of the scan interval.
double step_of(double interval_s, const model::Transducer& transducer, double omega) {
  const double fastest = 2.0 * std::numbers::pi *
                         std::max(transducer.load_cell ? transducer.load_cell->frequency_Hz : 0.0,
                                  transducer.anti_alias ? transducer.anti_alias->cutoff_Hz : 0.0);
  const double steps = interval_s * std::max(omega / kSlipPhase_rad, fastest / kTransducerPhase_rad);
  return interval_s / std::clamp(std::ceil(steps), 1.0, kMostSteps);
}

/// Appends, for each scan, what the transducer shows less the fitted slip.
class Course {
 public:
  Course(const estimate::Trace& trace, const model::Transducer& transducer, double step_s,
         base::LongColumn<double>& added)
      : trace_(trace), step_s_(step_s), response_(transducer, step_s), added_(added) {}

  /// The scans [fitted.first, end) by this slip.
  void follow(const FittedSlip& fitted, std::size_t end) {
    const model::SlipModel model{fitted.shared, fitted.slip, fitted.captured, trace_.belt};
    model::TurnedBasis basis{fitted.shared.oscillator()};
    model::TurnedBasis later{basis};
    const double lag_s = response_.lag_s();
    // The slips are fitted to what is shown, and so are late by the lag.
    const auto force_at = [&](double time_s) { return model.place(time_s + lag_s, later).value; };
    const auto fitted_at = [&](double time_s) { return model.place(time_s, basis).value; };
    for (std::size_t k = std::max(fitted.first, added_.size()); k < end; ++k) {
      const double time_s = trace_.time_s[k];
      const double before_s = k > 0 ? trace_.time_s[k - 1] : time_s;
      if (added_.size() < k || k == 0 || time_s - before_s > kFarthest_s) {
        while (added_.size() < k) added_.push_back(0.0);
        const double earlier = force_at(time_s - step_s_);
        const double force = force_at(time_s);
        response_.settle(force, (force - earlier) / step_s_);
      } else {
        for (long step = std::lround((time_s - before_s) / step_s_) - 1; step >= 0; --step)
          response_.next(force_at(time_s - static_cast<double>(step) * step_s_));
      }
      added_.push_back(response_.shown() - fitted_at(time_s));
    }
  }

 private:
  const estimate::Trace& trace_;
  double step_s_;
  model::TransducerResponse response_;
  base::LongColumn<double>& added_;
};

/// Calls `use` with each slip and the end of its scans: where the next one begins, if that is near.
void for_each_slip(const estimate::Trace& trace, const base::LongColumn<FittedSlip>& fitted,
                   const std::function<void(const FittedSlip& slip, std::size_t end)>& use) {
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const FittedSlip own = fitted[i];
    std::size_t end = own.end;
    if (i + 1 < fitted.size()) {
      const std::size_t next = fitted[i + 1].first;
      const bool is_near =
          trace.time_s[next] - trace.time_s[own.end - 1] < kFarthest_s &&
          !estimate::is_broken(trace, static_cast<double>(own.first), static_cast<double>(next));
      if (next < end || is_near) end = next;
    }
    use(own, end);
  }
}

/// The slips without noise, at their scans; elsewhere the values.
Column without_noise(const estimate::Trace& trace, const base::LongColumn<FittedSlip>& fitted,
                     const Column& values, const std::filesystem::path& scratch_folder) {
  Column course{scratch_folder};
  for_each_slip(trace, fitted, [&](const FittedSlip& slip, std::size_t end) {
    const model::SlipModel model{slip.shared, slip.slip, slip.captured, trace.belt};
    model::TurnedBasis basis{slip.shared.oscillator()};
    while (course.size() < slip.first) course.push_back(values[course.size()]);
    for (std::size_t k = course.size(); k < end; ++k)
      course.push_back(model.place(trace.time_s[k], basis).value + trace.drift.at(trace.time_s[k]));
  });
  while (course.size() < values.size()) course.push_back(values[course.size()]);
  return course;
}

/// The same scans with other values.
estimate::Trace with_values(const estimate::Trace& trace, Column values) {
  estimate::Trace other = trace.view();
  other.value = std::move(values);
  return other;
}

/// The first scans.
estimate::Trace first_part(const estimate::Trace& trace, std::size_t end,
                           const std::filesystem::path& scratch_folder) {
  estimate::Trace part{Column{scratch_folder},
                       Column{scratch_folder},
                       base::LongColumn<std::uint8_t>{scratch_folder},
                       trace.drift,
                       trace.belt,
                       trace.breaks,
                       trace.lost_s};
  for (std::size_t k = 0; k < end; ++k) {
    part.time_s.push_back(trace.time_s[k]);
    part.value.push_back(trace.value[k]);
    part.usable.push_back(trace.usable[k]);
  }
  std::erase_if(part.breaks, [end](std::size_t scan) { return scan >= end; });
  return part;
}

/// Change of a result in its standard errors; infinity where one is absent.
double moved(const TestEstimates& before, const TestEstimates& after, Estimate TestResults::*result) {
  const Estimate& from = before.results.*result;
  const Estimate& to = after.results.*result;
  return from.value && to.value && to.standard_error ? std::abs(*to.value - *from.value) / *to.standard_error
                                                     : std::numeric_limits<double>::infinity();
}

/// S - K is known as a bound alone, which has no standard error.
bool is_a_bound(const TestEstimates& estimates) {
  return estimates.results.delta_mu.value && !estimates.results.delta_mu.standard_error;
}

/// Sums of squared deviations of each result from that of `truth`.
class Scatter {
 public:
  void add(const TestResults& results, const TestResults& truth) {
    std::vector<std::optional<double>> values;
    for_each_result(truth,
                    [&](const ResultName&, const Estimate& estimate) { values.push_back(estimate.value); });
    squares_.resize(values.size(), 0.0);
    std::size_t i = 0;
    for_each_result(results, [&](const ResultName&, const Estimate& estimate) {
      if (estimate.value && values[i]) squares_[i] += std::pow(*estimate.value - *values[i], 2);
      ++i;
    });
  }
  [[nodiscard]] std::size_t size() const noexcept { return squares_.size(); }
  [[nodiscard]] double square(std::size_t result) const { return squares_[result]; }

 private:
  std::vector<double> squares_;
};

}  // namespace

Column ThroughTransducer::distortion(const estimate::Trace& trace,
                                     const base::LongColumn<FittedSlip>& fitted) const {
  Column added{scratch_folder_};
  if (!fitted.empty()) {
    Course course{trace, transducer_, step_of(interval_s_, transducer_, fitted.front().shared.omega), added};
    for_each_slip(trace, fitted, [&](const FittedSlip& slip, std::size_t end) { course.follow(slip, end); });
  }
  while (added.size() < trace.size()) added.push_back(0.0);
  return added;
}

std::optional<TestEstimates> ThroughTransducer::estimate(const estimate::Trace& trace,
                                                         const TestEstimates& seen, const Fit& fit) const {
  // A fixed point, at which the residuals are those of a fit through the transducer. How far a round moves
  // towards it is learnt from the one before: where a cell rings near the oscillation a whole round would
  // multiply an error of the slips by -0.8, and by 0.9 behind a slow filter. [Irons and Tuck, Int. J. Num.
  // Meth. Eng. 1:275, 1969]
  constexpr int kMostRounds = 25;
  constexpr int kMostFailures = 3;
  constexpr double kFirstPart = 0.6;
  constexpr double kLeastPart = 0.1;
  constexpr double kMostPart = 4.0;
  constexpr double kSettled = 0.02;  // Standard errors that S - K and K move in a whole round.
  constexpr double kLongestLag_rad =
      0.4 * std::numbers::pi;  // Else the next slip shows before this one has ended.
  if (seen.fitted.empty()) return std::nullopt;
  const double lag_s = model::TransducerResponse{transducer_, interval_s_}.lag_s();
  if (lag_s * std::as_const(seen.fitted).front().shared.omega > kLongestLag_rad) return std::nullopt;
  const Column& measured = trace.value;
  std::optional<TestEstimates> found;
  Column off{scratch_folder_};  // What is taken off.
  for (std::size_t k = 0; k < measured.size(); ++k) off.push_back(0.0);
  Column left_before;
  double part = kFirstPart;
  int failures = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    const TestEstimates& present = found ? *found : seen;
    if (present.fitted.empty() || failures > kMostFailures) return std::nullopt;
    const Column added = distortion(trace, present.fitted);
    Column left{scratch_folder_};
    double along = 0.0;
    double square = 0.0;
    for (std::size_t k = 0; k < measured.size(); ++k) {
      left.push_back(added[k] - std::as_const(off)[k]);
      if (round == 0) continue;
      const double change = std::as_const(left)[k] - std::as_const(left_before)[k];
      along += std::as_const(left_before)[k] * change;
      square += change * change;
    }
    if (square > 0.0) part = std::clamp(-part * along / square, kLeastPart, kMostPart);
    Column now{scratch_folder_};
    Column force{scratch_folder_};
    for (std::size_t k = 0; k < measured.size(); ++k) {
      now.push_back(std::as_const(off)[k] + part * std::as_const(left)[k]);
      force.push_back(measured[k] - std::as_const(now)[k]);
    }
    off = std::move(now);
    left_before = std::move(left);
    TestEstimates next = fit(with_values(trace, std::move(force)));
    if (!next.model_describes) ++failures;
    const double enough = kSettled * std::min(part, 1.0);
    const bool is_settled = (along < 0.0 || round == 0) &&
                            moved(present, next, &TestResults::mu_k) < enough &&
                            moved(present, next, &TestResults::omega) < enough &&
                            (moved(present, next, &TestResults::delta_mu) < enough || is_a_bound(next));
    found = std::move(next);
    if (is_settled) return found;
  }
  return std::nullopt;
}

Column ThroughTransducer::force(const estimate::Trace& trace, const TestEstimates& found) const {
  const Column added = distortion(trace, found.fitted);
  Column force{scratch_folder_};
  for (std::size_t k = 0; k < added.size(); ++k) force.push_back(trace.value[k] - added[k]);
  return force;
}

std::optional<ErrorFactors> ThroughTransducer::error_factors(const estimate::Trace& whole,
                                                             const TestEstimates& found, double sigma,
                                                             const Fit& fit) const {
  constexpr int kTraces = 12;  // The scatter is then known to a fifth.
  constexpr int kFewestSettled = 8;
  constexpr std::uint64_t kSeed = 1;
  TestEstimates start;
  for (std::size_t i = 0; i < std::min(found.fitted.size(), kMostSlipsOfErrors); ++i)
    start.fitted.push_back(std::as_const(found.fitted)[i]);
  const std::size_t end =
      start.fitted.size() < found.fitted.size() ? std::as_const(start.fitted).back().end : whole.size();
  const estimate::Trace trace = first_part(whole, end, scratch_folder_);
  const Column added = distortion(trace, start.fitted);
  const Column ideal = without_noise(trace, start.fitted, force(trace, start), scratch_folder_);
  const TestEstimates truth = fit(with_values(trace, ideal.view()));
  std::mt19937_64 random{kSeed};
  std::normal_distribution<double> noise{0.0, sigma};
  Scatter plain;
  Scatter through;
  int settled = 0;
  for (int i = 0; i < kTraces; ++i) {
    Column shown{scratch_folder_};
    Column alone{scratch_folder_};
    for (std::size_t k = 0; k < trace.size(); ++k) {
      const double error = noise(random);
      alone.push_back(ideal[k] + error);
      shown.push_back(ideal[k] + added[k] + error);
    }
    const TestEstimates by_fit = fit(with_values(trace, std::move(alone)));
    const auto by_rounds = estimate(with_values(trace, std::move(shown)), start, fit);
    if (!by_rounds || !by_rounds->model_describes || !by_fit.model_describes) continue;
    plain.add(by_fit.results, truth.results);
    through.add(by_rounds->results, truth.results);
    ++settled;
  }
  if (settled < kFewestSettled) return std::nullopt;
  ErrorFactors factors;
  for (std::size_t i = 0; i < plain.size(); ++i)
    factors.push_back(plain.square(i) > 0.0 ? std::max(1.0, std::sqrt(through.square(i) / plain.square(i)))
                                            : 1.0);
  return factors;
}

void widen_errors(const ErrorFactors& factors, TestEstimates& estimates) {
  if (factors.empty()) return;
  double of_tester = 1.0;
  std::size_t i = 0;
  for_each_result(estimates.results, [&](const ResultName&, Estimate& estimate) {
    const double factor = factors[i++];
    if (estimate.standard_error) *estimate.standard_error *= factor;
    if (&estimate == &estimates.results.omega || &estimate == &estimates.results.gamma_over_2omega)
      of_tester = std::max(of_tester, factor);
  });
  if (estimates.tester) estimates.tester->covariance *= of_tester * of_tester;
}

}  // namespace stickslip::analysis

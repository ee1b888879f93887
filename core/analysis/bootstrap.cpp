#include "core/analysis/bootstrap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <memory>
#include <optional>
#include <random>
#include <thread>
#include <utility>

#include <Eigen/Cholesky>

#include "core/analysis/model_results.hpp"
#include "core/base/contract.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

constexpr std::size_t kFewestToDraw = 8;
constexpr double kLeastConverged = 0.9;
constexpr std::size_t kMostDrawingTasks = 16;
constexpr double kTailShare = 0.025;
/// Change of the cost below which a fit has settled: all parameters together then move by 0.05 of a standard
/// error, which adds 0.1 % to their scatter.
constexpr double kDrawingSettled = 1e-3;

/// What a drawing gives: S, K, S − K, ω, γ/2ω.
using Drawn = std::array<double, 5>;
constexpr std::size_t kWithDrift = 2;  // S and K.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kDrawnNames{
    {{"mu_s", "1"}, {"mu_k", "1"}, {"delta_mu", "1"}, {"omega", "rad/s"}, {"gamma_over_2omega", "1"}}};

Drawn results_of(double S, double K, const model::SharedParameters& shared) {
  return {S, K, S - K, shared.omega, shared.oscillator().gamma_over_2omega()};
}

/// Random numbers of a drawing, whichever thread makes it.
std::mt19937_64 stream_of(std::uint64_t seed, std::size_t drawing) {
  constexpr unsigned kHalf = 32;
  std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> kHalf),
                      static_cast<std::uint32_t>(drawing)};
  return std::mt19937_64{words};
}

/// The prior as another characterisation and another measurement of the speed would have told it.
estimate::SharedPrior drawn_from(estimate::SharedPrior prior, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  if (prior.coupling) {
    const Eigen::Vector2d step = Eigen::LLT<Eigen::Matrix2d>{prior.coupling->covariance}.matrixL() *
                                 Eigen::Vector2d{normal(random), normal(random)};
    prior.coupling->omega += step[0];
    prior.coupling->gamma_over_2omega += step[1];
  }
  if (prior.belt) prior.belt->speed_over_gravity_s += prior.belt->standard_error_s * normal(random);
  return prior;
}

/// Numbers of the slips of a drawing.
std::vector<std::size_t> draw(std::size_t slips, std::size_t block, std::mt19937_64& random) {
  std::uniform_int_distribution<std::size_t> begin{0, slips - 1};
  std::vector<std::size_t> drawn;
  while (drawn.size() < slips) {
    const std::size_t first = begin(random);
    for (std::size_t i = 0; i < block && drawn.size() < slips; ++i) drawn.push_back((first + i) % slips);
  }
  return drawn;
}

/// Each slip by itself.
std::optional<Drawn> fit_each(const estimate::Trace& trace, const SlipEstimates& estimates,
                              const std::vector<estimate::SlipWindow>& slips,
                              const std::vector<std::size_t>& drawn, double sigma,
                              const estimate::SharedPrior& prior) {
  std::vector<estimate::SlipWindow> windows;
  windows.reserve(drawn.size());
  for (const std::size_t slip : drawn) windows.push_back(slips[slip]);
  const estimate::SlipFit fit =
      estimate::fit_slips(trace, windows, estimates.fit.shared, sigma, prior, kDrawingSettled);
  if (!fit.converged) return std::nullopt;
  signal::RunningMean S;
  signal::RunningMean K;
  for (const estimate::SlipWindow& window : windows) {
    S.add(window.slip.S);
    K.add(window.slip.K);
  }
  return results_of(S.mean, K.mean, fit.shared);
}

/// One S and K for all: the scans of each slip drawn, moved by whole periods to where it is put.
std::optional<Drawn> fit_all(const estimate::Trace& trace, const estimate::UniformFit& uniform,
                             const model::UniformTrajectory& course,
                             const std::vector<estimate::SlipWindow>& slips,
                             const std::vector<std::size_t>& drawn, double sigma,
                             const estimate::SharedPrior& prior) {
  estimate::Trace moved{{}, {}, {}, trace.drift, trace.belt, {}, 0.0};
  for (std::size_t place = 0; place < drawn.size(); ++place) {
    const estimate::SlipWindow& from = slips[drawn[place]];
    const double cycles = std::round((slips[place].slip.onset_s - from.slip.onset_s) / course.period_s());
    const double later_s = cycles * course.period_s();
    for (std::size_t k = from.first; k < from.end; ++k) {
      moved.time_s.push_back(trace.time_s[k] + later_s);
      // Without the drift where it was, with that where it is put.
      moved.value.push_back(trace.level(k) + trace.drift.at(trace.time_s[k] + later_s));
      moved.usable.push_back(trace.usable[k]);
    }
  }
  const estimate::UniformFit fit =
      estimate::fit_uniform(moved, 0, moved.size(), uniform.parameters, sigma, prior);
  if (!fit.converged) return std::nullopt;
  return results_of(fit.parameters.slip.S, fit.parameters.slip.K, fit.parameters.shared);
}

BootstrapSpread spread_of(const std::pair<std::string_view, std::string_view>& name,
                          std::vector<double> values) {
  std::ranges::sort(values);
  signal::RunningVariance variance;
  for (const double value : values) variance.add(value);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return {name.first, name.second, std::sqrt(variance.variance()), at(kTailShare), at(1.0 - kTailShare)};
}

}  // namespace

Bootstrap bootstrap_slips(const estimate::Trace& trace, const SlipEstimates& estimates, double sigma,
                          const estimate::SharedPrior& prior, const BootstrapSettings& settings) {
  STICKSLIP_EXPECTS(settings.count > 0);
  Bootstrap result;
  result.settings = settings;
  const auto none = [&result](std::string why) {
    result.reason = std::move(why);
    return result;
  };
  if (!trace.belt.is_constant()) return none("the pull speed changes");
  const std::vector<estimate::SlipWindow> slips = slips_that_count(estimates);
  if (slips.size() < kFewestToDraw)
    return none(fmt::format("{} slips that count in the means are needed, the test has {}", kFewestToDraw,
                            slips.size()));
  const auto course = estimates.uniform ? model::UniformTrajectory::make(estimates.uniform->parameters)
                                        : std::optional<model::UniformTrajectory>{};
  signal::RunningMean drift;  // As in the results, in whose S and K it is.
  for (const estimate::SlipWindow& slip : slips) drift.add(estimates.drift.at(slip.slip.onset_s));
  result.block = static_cast<std::size_t>(std::lround(std::cbrt(static_cast<double>(slips.size()))));
  // On each processor every so many of them: their order does not matter.
  const std::size_t tasks =
      std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, kMostDrawingTasks);
  const auto fit_every = [&](const estimate::Trace& own, std::size_t first) {
    std::vector<Drawn> found;
    for (std::size_t i = first; i < settings.count; i += tasks) {
      std::mt19937_64 random = stream_of(settings.seed, i);
      const std::vector<std::size_t> drawn = draw(slips.size(), result.block, random);
      const estimate::SharedPrior told = drawn_from(prior, random);
      const std::optional<Drawn> one =
          course ? fit_all(own, *estimates.uniform, *course, slips, drawn, sigma, told)
                 : fit_each(own, estimates, slips, drawn, sigma, told);
      if (one) found.push_back(*one);
    }
    return found;
  };
  std::vector<std::future<std::vector<Drawn>>> fits;
  for (std::size_t task = 0; task < tasks; ++task) {
    // It has a name, as async moves what it is given before it knows whether there is room for a thread.
    const auto fit_own = [&fit_every, task, own = std::make_shared<const estimate::Trace>(trace.view())] {
      return fit_every(*own, task);
    };
    fits.push_back(std::async(fit_own));
  }
  std::array<std::vector<double>, kDrawnNames.size()> values;
  for (std::future<std::vector<Drawn>>& fit : fits) {
    for (const Drawn& one : fit.get()) {
      for (std::size_t j = 0; j < one.size(); ++j)
        values[j].push_back(one[j] + (j < kWithDrift ? drift.mean : 0.0));
    }
  }
  result.converged = values.front().size();
  if (static_cast<double>(result.converged) < kLeastConverged * static_cast<double>(settings.count))
    return none(fmt::format("{} of {} fits converged", result.converged, settings.count));
  for (std::size_t j = 0; j < values.size(); ++j)
    result.spreads.push_back(spread_of(kDrawnNames[j], std::move(values[j])));
  return result;
}

}  // namespace stickslip::analysis

#include "core/analysis/sections.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "core/analysis/cycle_features.hpp"
#include "core/analysis/ladder.hpp"
#include "core/analysis/model_results.hpp"
#include "core/analysis/slip_estimator.hpp"
#include "core/base/nan.hpp"
#include "core/detect/regime_rule.hpp"

namespace stickslip::analysis {
namespace {

/// Mean of one result over the sections, weighted by their slips.
class PooledEstimate {
 public:
  void add(const Estimate& estimate, double slips) {
    first_ = slips_ == 0.0 ? estimate : first_;
    ++sections_;
    slips_ += slips;
    if (!estimate.value) {
      nothing_ = nothing_.value_or(estimate);
      return;
    }
    value_ += slips * *estimate.value;
    variance_ += std::pow(slips * estimate.standard_error.value_or(std::nan("")), 2);
    has_systematic_ = has_systematic_ || estimate.systematic_uncertainty;
    systematic_ += slips * estimate.systematic_uncertainty.value_or(0.0);
    for_each_part(estimate.systematic_parts,
                  [&](UncertaintySource source, const std::optional<double>& size) {
                    if (size) parts_[source] = parts_[source].value_or(0.0) + slips * *size;
                  });
  }

  [[nodiscard]] Estimate mean() const {
    if (sections_ == 1) return first_;
    if (nothing_) return *nothing_;
    Estimate mean = Estimate::of(value_ / slips_, std::sqrt(variance_) / slips_);
    if (has_systematic_) {
      // Only parts that add as they are: their means make the mean of the totals.
      mean.systematic_uncertainty = systematic_ / slips_;
      mean.systematic_parts = parts_;
      for_each_part(mean.systematic_parts, [&](UncertaintySource, std::optional<double>& size) {
        if (size) *size /= slips_;
      });
    }
    return mean;
  }

 private:
  int sections_ = 0;
  double slips_ = 0.0;
  Estimate first_;
  std::optional<Estimate> nothing_;
  double value_ = 0.0;
  double variance_ = 0.0;
  bool has_systematic_ = false;
  double systematic_ = 0.0;
  SystematicParts parts_;
};

class PooledResults {
 public:
  void add(TestResults& section, std::size_t slips) {
    std::size_t i = 0;
    for_each_result(section, [&](const ResultName&, const Estimate& estimate) {
      if (i == pooled_.size()) pooled_.emplace_back();
      pooled_[i++].add(estimate, static_cast<double>(slips));
    });
  }
  [[nodiscard]] TestResults mean() const {
    TestResults results;
    std::size_t i = 0;
    for_each_result(results, [&](const ResultName&, Estimate& estimate) { estimate = pooled_[i++].mean(); });
    return results;
  }

 private:
  std::vector<PooledEstimate> pooled_;
};

/// Mean of what the sections say about the tester, weighted by their covariances.
class PooledTester {
 public:
  void add(const SlipEstimates& section) {
    ++sections_;
    if (!section.fit.converged) {
      converged_ = false;
      return;
    }
    latest_ = section.tester();
    const Eigen::Matrix3d weight = latest_.covariance.inverse();
    weight_ += weight;
    weighted_ += weight * vector_of(latest_);
  }
  [[nodiscard]] std::optional<TesterEstimate> mean() const {
    if (!converged_) return std::nullopt;
    if (sections_ == 1) return latest_;
    TesterEstimate mean;
    mean.covariance = weight_.inverse();
    const Eigen::Vector3d value = mean.covariance * weighted_;
    mean.omega = value[0];
    mean.gamma_over_2omega = value[1];
    mean.speed_over_gravity_s = value[2];
    return mean;
  }

 private:
  static Eigen::Vector3d vector_of(const TesterEstimate& tester) {
    return {tester.omega, tester.gamma_over_2omega, tester.speed_over_gravity_s};
  }

  int sections_ = 0;
  bool converged_ = true;
  TesterEstimate latest_;
  Eigen::Matrix3d weight_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d weighted_ = Eigen::Vector3d::Zero();
};

/// Slips of the next section: no last one is much shorter than the others.
std::size_t next_size(std::size_t left, std::size_t most) {
  if (left <= most) return left;
  return left < 2 * most ? left / 2 + 1 : most;
}

/// The next section begins with a slip that began from sticking: its last one of those, which both have.
std::size_t begin_of_next(const SlipEstimates& section) {
  for (std::size_t i = section.ends.size() - 1; i > 1; --i) {
    if (section.ends[i - 1] == SlipEnd::kCaptured) return i;
  }
  return section.ends.size() - 1;
}

/// The rows of a section, of which the first also was the last of the section before.
void append(const std::vector<detect::Cycle>& rows, std::size_t count, std::size_t first_slip,
            double last_capture_s, TestEstimates& estimates) {
  for (std::size_t i = 0; i < count; ++i) {
    detect::Cycle row = rows[i];
    row.number += static_cast<std::int64_t>(first_slip);
    if (i == 0 && first_slip > 0) {
      row.flags &= static_cast<std::uint8_t>(~detect::kCycleIsFirst);
      row.stick_time_s = row.onset_time_s - last_capture_s;
    }
    if ((row.flags & detect::kCycleCaptured) != 0) ++estimates.captured;
    estimates.cycles.push_back(row);
  }
}

/// The slips of a section before `count` that began from sticking.
void append_fitted(const SlipEstimates& section, std::size_t count, base::LongColumn<FittedSlip>& fitted) {
  for (std::size_t i = 0; i < count; ++i) {
    if (!section.has_window(i) || (i > 0 && section.window_of_slip[i] == section.window_of_slip[i - 1]))
      continue;
    const estimate::SlipWindow& window = section.windows[section.window_of_slip[i]];
    fitted.push_back({window.first, window.end, window.captured, window.slip, section.fit.shared});
  }
}

/// Fits the sections of a test one by one. On threads the next section, where it is likely to begin, is
/// fitted while this one is.
class SectionFitter {
 public:
  SectionFitter(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips, double sigma,
                const estimate::SharedPrior& prior, const SectionSettings& settings)
      : trace_(trace), slips_(slips), sigma_(sigma), prior_(prior), settings_(settings) {
    // Where the speed changes, how each slip ended tells about all the others: escape_speeds().
    if (!trace.belt.is_constant()) settings_.most = slips.size();
  }

  struct Section {
    std::vector<detect::Fall> slips;
    SlipEstimates estimates;
  };

  /// The section that begins with slip `first`.
  Section next(std::size_t first) {
    Task own = next_.first == first && next_.section.valid() ? std::move(next_) : begin(first);
    const std::size_t end = first + own.size;
    next_ = {};  // After a wrong guess this waits until that fit has ended.
    if (settings_.on_threads && end < slips_.size()) next_ = begin(end - 1);
    return own.section.get();
  }

 private:
  struct Task {
    std::size_t first = 0;
    std::size_t size = 0;
    std::future<Section> section;
  };

  [[nodiscard]] Task begin(std::size_t first) const {
    const std::size_t size = next_size(slips_.size() - first, settings_.most);
    std::vector<detect::Fall> own;
    own.reserve(size);
    for (std::size_t i = 0; i < size; ++i) own.push_back(slips_[first + i]);
    // A task has a name, as async moves what it is given before it knows whether there is room for a thread.
    const auto task = [trace = std::make_shared<const estimate::Trace>(trace_.view()), own, sigma = sigma_,
                       prior = prior_, first_counts = settings_.first_counts && first == 0] {
      return Section{own, estimate_slips(*trace, own, sigma, prior, first_counts)};
    };
    const auto policy =
        settings_.on_threads ? std::launch::async | std::launch::deferred : std::launch::deferred;
    return {first, size, std::async(policy, task)};
  }

  const estimate::Trace& trace_;
  const base::LongColumn<detect::Fall>& slips_;
  double sigma_;
  const estimate::SharedPrior& prior_;
  SectionSettings settings_;
  Task next_;
};

/// Whether slips end in sticking in the likeliest course: a single odd one is outvoted.
bool sticks(std::size_t slip_count, const base::LongColumn<double>& log_likelihood_ratios) {
  return detect::judge_regime(slip_count, log_likelihood_ratios, detect::Description::kRefuted)
             .captured.value_or(0) > 0;
}

}  // namespace

TestEstimates estimate_in_sections(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                                   double sigma, const estimate::SharedPrior& prior,
                                   const model::Tester& tester, const SectionSettings& settings) {
  TestEstimates whole;
  whole.log_likelihood_ratios = base::LongColumn<double>{settings.scratch};
  whole.cycles = base::LongColumn<detect::Cycle>{settings.scratch};
  whole.onset_errors_s = base::LongColumn<double>{settings.scratch};
  whole.fitted = base::LongColumn<FittedSlip>{settings.scratch};
  PooledResults results;
  PooledTester testers;
  SectionFitter sections{trace, slips, sigma, prior, settings};
  double last_capture_s = std::nan("");
  for (std::size_t first = 0; whole.cycles.size() < slips.size();) {
    const auto [section, estimates] = sections.next(first);
    const std::size_t size = section.size();
    whole.model_describes = whole.model_describes && model_describes(estimates, sigma);
    Misfit misfit;
    misfit.add(trace, estimates, sigma);
    whole.misfit.add(misfit);
    testers.add(estimates);
    TestResults own;
    model_results(section, estimates, misfit, tester, sigma, own);
    if (!trace.belt.is_constant()) {
      no_feature_results("the pull speed changes during the test", own);
    } else if (model_describes(estimates, sigma)) {
      feature_results(trace, section, estimates, own);
    }
    results.add(own, size);

    const std::size_t count = first + size < slips.size() ? begin_of_next(estimates) : size;
    const std::vector<detect::Cycle> rows = cycle_table(trace, section, estimates);
    append(rows, count, first, last_capture_s, whole);
    for (std::size_t i = 0; i < count; ++i) {
      whole.onset_errors_s.push_back(
          std::isfinite(rows[i].onset_time_s)
              ? estimates.fit.onset_error_s(estimates.windows[estimates.window_of_slip[i]])
              : base::kNaN);
    }
    last_capture_s = rows[count - 1].capture_time_s;
    if (settings.keep_fitted && estimates.fit.converged) append_fitted(estimates, count, whole.fitted);
    const auto& ratios = estimates.log_likelihood_ratios;
    for (std::size_t i = 0; i < std::min(count, ratios.size()); ++i) {
      whole.log_likelihood_ratios.push_back(ratios[i]);
    }
    if (settings.keep_section && count == slips.size() && estimates.fit.converged)
      whole.section = std::make_shared<const SlipEstimates>(estimates);
    first += count;
  }
  whole.prior = prior;
  whole.results = results.mean();
  whole.tester = testers.mean();
  const Estimate& delta_mu = whole.results.delta_mu;
  if (whole.model_describes && delta_mu.value) {
    constexpr double kSure = 2.0;
    const double sure = *delta_mu.value + kSure * total_error(delta_mu);
    const double bound = std::min(sure, whole.results.amplitude.value.value_or(sure));
    if (sure <= 0.0) {
      whole.model_describes = false;
      no_model_results("the fit finds S below K", whole.results);
    } else if (!(delta_mu.standard_error.value_or(0.0) < *delta_mu.value) &&
               sticks(slips.size(), whole.log_likelihood_ratios)) {
      // A slip that sticks again drops by about S − K: turning points tell more.
      whole.model_describes = false;
      no_model_results("the fit does not tell S from K", whole.results);
    } else if (*delta_mu.value <= 0.0 ||
               (whole.captured == 0 && delta_mu.standard_error.value_or(0.0) >= 0.5 * bound)) {
      tell_bound(bound, whole.results);  // The amplitude of a ring-down tells more than its fit.
    }
  }
  return whole;
}

}  // namespace stickslip::analysis

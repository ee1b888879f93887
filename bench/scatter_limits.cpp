// How well S − K is known of paper whose slips differ by 30 % (docs/detector-limits.md, "Slips that
// differ"): single tests, the slip that escapes, and replicates pooled by cycle, at three speeds.
//
//     scatter_limits [PULLS [FIRST]]      # 1000 pulls of 2 s at each speed, seeds from 1 on

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "bench/arguments.hpp"
#include "tests/support/scatter_trials.hpp"

namespace {

using namespace stickslip;
using test::ScatterTrials;

/// A part of the true mean, in per cent.
double percent(double value) { return 100.0 * value / ScatterTrials::kDeltaMu; }

void print(double speed_in_per_min, const ScatterTrials& trials) {
  const analysis::PooledDeltaMu pooled = analysis::pool_delta_mu(trials.cycles);
  const auto bias = [](const analysis::Estimate& mean) {
    return mean.value ? fmt::format("{:+.2f} ± {:.2f}", percent(*mean.value - ScatterTrials::kDeltaMu),
                                    percent(mean.standard_error.value_or(std::nan(""))))
                      : std::string{"–"};
  };
  const ScatterTrials::Escapes escapes = trials.escapes();
  const std::string own = escapes.count < 2 ? "–"
                                            : fmt::format("{:.2f}; {:+.2f} ± {:.2f}", percent(escapes.rms),
                                                          percent(escapes.bias), percent(escapes.bias_error));
  fmt::print("| {} | {:.3f} ± {:.3f} | {:.1f} | {} | {} | {} | {} | {} | {} |\n", speed_in_per_min,
             trials.rms_over_sampling(), trials.rms_error_of_it(),
             100.0 * static_cast<double>(pooled.escaped_count) / static_cast<double>(pooled.slip_count),
             escapes.count, own, bias(pooled.mean), bias(trials.mean_of_means()), bias(pooled.captured_mean),
             trials.without_delta_mu());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int pulls = test::argument(argc, argv, 1, 1000);
  const int first = test::argument(argc, argv, 2, 1);
  fmt::print(
      "{} pulls of {} s a speed, S - K 0.05 with {:.0f} % log-normal scatter, first slips left out; biases "
      "with "
      "their standard errors, in % of the mean S - K\n\n"
      "| in/min | one test: rms error over CV/sqrt(M) | slips that escape, % | escapes measured | their own "
      "S - K: "
      "rms error; bias | pooled by cycle: bias | mean of the tests' means: bias | captured alone: bias | "
      "tests "
      "without S - K |\n|---|---|---|---|---|---|---|---|---|\n",
      pulls, ScatterTrials::kPull_s, 100.0 * ScatterTrials::kCv);
  for (const double speed_in_per_min : {3.0, 6.0, 12.0}) {
    print(speed_in_per_min, ScatterTrials{speed_in_per_min, pulls, first});
  }
  return 0;
}

// What ramp tests say of S − K and of the threshold speed: ramps from 0.3 to 1.5 times the threshold speed
// over paper of different scatter, through the whole analysis, against the simulator's truth. One row for
// each.
//
//     ramp_limits [TESTS [SEED]]      # 100 tests a row, seed 1

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>

#include "bench/arguments.hpp"
#include "tests/support/ramp_trials.hpp"

namespace {

using namespace stickslip;

void print(const test::RampTrials& trials) {
  fmt::print("{:4.1f} {:4.0f} % {:6.0f} | {:+7.3f} +- {:5.3f} {:7.3f} {:7} {:6.2f} | {:6.3f} +- {:5.3f} | ",
             1e3 * trials.acceleration_m_per_s2, 100.0 * trials.cv, trials.slips.mean,
             100.0 * trials.pooled_bias(), 100.0 * trials.delta_mu.standard_error(),
             100.0 * trials.delta_mu.sd(),
             trials.cv > 0.0 ? fmt::format("{:.3f}", trials.rms_over_sampling()) : "-",
             trials.delta_mu_z.sd(), trials.escape.mean, trials.escape.sd());
  fmt::print("{:+6.2f} +- {:4.2f} {:6.2f} {:6.2f} | {} {}\n", 100.0 * (trials.corrected.mean - 1.0),
             100.0 * trials.corrected.standard_error(), 100.0 * trials.corrected.sd(),
             trials.corrected_z.sd(), trials.without_delta_mu, trials.without_escape);
  std::fflush(stdout);
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): what std::terminate says is enough of a message for a bench.
int main(int argc, char** argv) {
  const auto count = test::argument(argc, argv, 1, 100);
  const auto seed = test::argument<std::uint64_t>(argc, argv, 2, 1);
  fmt::print(
      "{} ramps a row from 0.3 to 1.5 v_th = {:.3f} mm/s, seeds from {} on; S - K 0.05, noise 0.001, "
      "350 Hz, gamma/2omega 0.022\n",
      count, 1e3 * test::RampTrials::threshold_m_per_s(), seed);
  fmt::print("                     | S - K: pooled    sd of a  rms/    z  | first escape    | corrected\n");
  fmt::print(
      "mm/s2   CV  slips | bias, %           test, %  CV/vN   sd | / v_th    sd    | bias, %   sd, %    z sd "
      "| "
      "without\n");
  for (const double acceleration : {0.1e-3, 0.5e-3, 2e-3}) {
    for (const double cv : {0.0, 0.1, 0.2}) {
      test::RampTrials trials{acceleration, cv};
      trials.run(seed, count);
      print(trials);
    }
  }
  return 0;
}

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/accuracy/method.hpp"
#include "core/accuracy/peer_sled.hpp"
#include "core/accuracy/plain_belt.hpp"

namespace stickslip::accuracy {
namespace {

using sim::Motion;

/// Largest product of step and slope of the friction: half of the method's stability limit 2.78.
constexpr double kStepTimesSlope = 1.4;
constexpr int kFewestSteps = 4;

using State = std::array<double, 2>;  // c, c′

class Tanh final : public Method {
 public:
  Tanh(double width, double stribeck_over_tanh) : width_(width), stribeck_over_tanh_(stribeck_over_tanh) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "tanh friction, Runge-Kutta 4"; }
  [[nodiscard]] std::string setting() const override {
    return fmt::format("width {:g} of the speed", width_);
  }
  [[nodiscard]] std::string_view lacks(const Motion& motion) const noexcept override {
    return lacks_reference(motion);
  }
  RunOutcome run(const Motion& motion, double scan_rate_Hz, std::uint64_t /*seed*/,
                 std::span<double> coefficient) const override {
    const PeerSled sled{motion};
    double fastest = 0.0;
    for (const sim::BeltSegment& segment : motion.belt) {
      fastest = std::fmax(fastest, std::abs(motion.oscillator.stick_rate_per_s(segment.speed_m_per_s,
                                                                               motion.gravity_m_per_s2)));
    }
    const double w = fastest > 0.0 ? width_ * fastest : 1.0;
    const double slope = sled.omega0_squared * sled.S / w;
    const int steps =
        std::max(kFewestSteps, static_cast<int>(std::ceil(slope / kStepTimesSlope / scan_rate_Hz)));
    const double step_s = 1.0 / (scan_rate_Hz * steps);
    PlainBelt belt{motion};
    const auto derivative = [&](const State& x) -> State {
      const double z = (belt.rate() - x[1]) / w;
      const double stribeck = z / stribeck_over_tanh_;
      const double mu = (sled.K + (sled.S - sled.K) * std::exp(-stribeck * stribeck)) * std::tanh(z);
      return {x[1], sled.pull(x[0], x[1]) + sled.omega0_squared * mu};
    };
    const auto moved = [](const State& x, const State& dx, double h) -> State {
      return {x[0] + h * dx[0], x[1] + h * dx[1]};
    };
    State x{PeerSled::start_c(motion), PeerSled::start_rate(motion)};
    bool slides = false;
    std::int64_t captures = 0;
    std::int64_t step = 0;
    for (double& reading : coefficient) {
      reading = sled.one_way ? std::fmax(x[0], 0.0) : x[0];
      for (int i = 0; i < steps; ++i, ++step) {
        const double now_s = (static_cast<double>(step) + 0.5) * step_s;
        if (belt.end_s() <= now_s) belt.pass(now_s);
        if (belt.halts_when_unloaded() && x[0] <= 0.0) belt.halt();
        const State k1 = derivative(x);
        const State k2 = derivative(moved(x, k1, step_s / 2.0));
        const State k3 = derivative(moved(x, k2, step_s / 2.0));
        const State k4 = derivative(moved(x, k3, step_s));
        x[0] += step_s / 6.0 * (k1[0] + 2.0 * k2[0] + 2.0 * k3[0] + k4[0]);
        x[1] += step_s / 6.0 * (k1[1] + 2.0 * k2[1] + 2.0 * k3[1] + k4[1]);
        // It never sticks: what comes nearest to it is a belt that is faster by less than the widths.
        const double z = std::abs(belt.rate() - x[1]) / w;
        if (slides && z < 1.0) ++captures;
        slides = slides ? z >= 1.0 : z > stribeck_over_tanh_;
      }
    }
    return {captures, 0};
  }

 private:
  double width_;
  double stribeck_over_tanh_;
};

}  // namespace

std::unique_ptr<Method> make_tanh(double width, double stribeck_over_tanh) {
  return std::make_unique<Tanh>(width, stribeck_over_tanh);
}

}  // namespace stickslip::accuracy

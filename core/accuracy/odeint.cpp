#include <fmt/format.h>

#include <array>
#include <cmath>

#include <boost/numeric/odeint.hpp>

#include "core/accuracy/method.hpp"
#include "core/accuracy/peer_sled.hpp"
#include "core/accuracy/plain_belt.hpp"

namespace stickslip::accuracy {
namespace {

namespace odeint = boost::numeric::odeint;
using sim::Motion;

using State = std::array<double, 2>;  // c, c′

/// Resolution of an event's time at which the bisection ends, s.
constexpr double kClosest_s = 1e-15;

class Odeint final : public Method {
 public:
  explicit Odeint(double tolerance) : tolerance_(tolerance) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "odeint dopri5 with bisection"; }
  [[nodiscard]] std::string setting() const override { return fmt::format("tolerance {:.0e}", tolerance_); }
  [[nodiscard]] std::string_view lacks(const Motion& motion) const noexcept override {
    return lacks_reference(motion);
  }
  RunOutcome run(const Motion& motion, double scan_rate_Hz, std::uint64_t /*seed*/,
                 std::span<double> coefficient) const override {
    Sled sled{PeerSled{motion}, PlainBelt{motion}, tolerance_, {PeerSled::start_c(motion), 0.0}};
    std::int64_t scan = 0;
    for (double& reading : coefficient) {
      sled.go_to(static_cast<double>(scan++) / scan_rate_Hz);
      reading = sled.forces.one_way ? std::fmax(sled.x[0], 0.0) : sled.x[0];
    }
    return {sled.captures, 0};
  }

 private:
  struct Sled {
    PeerSled forces;
    PlainBelt belt;
    double tolerance;
    State x;
    double now_s = 0.0;
    double belt_rate = 0.0;
    double side = 1.0;  ///< Of the belt's speed on which the sled slides: 1 slower, −1 faster.
    bool sticks = true;
    std::int64_t captures = 0;

    void go_to(double instant_s) {
      while (now_s < instant_s) {
        belt.pass(now_s);
        if (belt.halts_when_unloaded() && x[0] <= 0.0) belt.halt();
        if (belt.rate() != belt_rate) {
          belt_rate = belt.rate();
          sticks = false;
          side = x[1] < belt_rate ? 1.0 : -1.0;
        }
        const double until_s = std::fmin(instant_s, belt.end_s());
        if (sticks) {
          stick_until(until_s);
        } else {
          slide_until(until_s);
        }
      }
    }

    void stick_until(double until_s) {
      const double limit = std::copysign(forces.S, belt_rate) - forces.damper_share_s * belt_rate;
      double end_s = until_s;
      if (belt_rate != 0.0) end_s = std::fmin(end_s, now_s + (limit - x[0]) / belt_rate);
      const bool gives_way = end_s < until_s;
      const bool unloads = belt.halts_when_unloaded() && belt_rate < 0.0 && now_s - x[0] / belt_rate < end_s;
      if (unloads) {
        now_s -= x[0] / belt_rate;
        x[0] = 0.0;
        return;
      }
      x[0] += belt_rate * (end_s - now_s);
      now_s = end_s;
      if (!gives_way) return;
      x[0] = limit;
      sticks = false;
      side = belt_rate > 0.0 ? 1.0 : -1.0;
    }

    void slide_until(double until_s) {
      const State end = slid(until_s - now_s);
      if (!(side * (end[1] - belt_rate) > 0.0)) {
        x = end;
        now_s = until_s;
        return;
      }
      double low = 0.0;
      double high = until_s - now_s;
      while (high - low > kClosest_s) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) break;
        (side * (slid(middle)[1] - belt_rate) > 0.0 ? high : low) = middle;
      }
      x = slid(high);
      now_s += high;
      captures += !forces.one_way || x[0] >= 0.0 ? 1 : 0;
      sticks = forces.holds(x[0], belt_rate);
      if (sticks) {
        x[1] = belt_rate;
      } else {
        side = -side;
      }
    }

    [[nodiscard]] State slid(double duration_s) const {
      State to = x;
      if (!(duration_s > 0.0)) return to;
      const double friction = side * forces.omega0_squared * forces.K;
      const auto equation = [this, friction](const State& at, State& derivative, double /*t*/) {
        derivative = {at[1], forces.pull(at[0], at[1]) + friction};
      };
      odeint::integrate_adaptive(
          odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_dopri5<State>()), equation, to,
          0.0, duration_s, duration_s);
      return to;
    }
  };

  double tolerance_;
};

}  // namespace

std::unique_ptr<Method> make_odeint(double tolerance) { return std::make_unique<Odeint>(tolerance); }

}  // namespace stickslip::accuracy

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <boost/numeric/odeint.hpp>

#include "core/accuracy/method.hpp"
#include "core/accuracy/peer_sled.hpp"
#include "core/accuracy/plain_belt.hpp"
#include "core/sim/bracket.hpp"

namespace stickslip::accuracy {
namespace {

namespace odeint = boost::numeric::odeint;
using sim::Motion;

using State = std::array<double, 2>;  // c, c′

struct DormandPrince {
  static constexpr std::string_view kName = "odeint dopri5, dense output";
  static auto stepper(double tolerance) {
    return odeint::make_dense_output(tolerance, tolerance, odeint::runge_kutta_dopri5<State>());
  }
};

/// Order up to 16 as the tolerance asks.
struct BulirschStoer {
  static constexpr std::string_view kName = "odeint Bulirsch-Stoer, dense output";
  static auto stepper(double tolerance) {
    return odeint::bulirsch_stoer_dense_out<State>(tolerance, tolerance);
  }
};

/// A sled that slides one way, in a coupling that is taut or slack throughout: a smooth motion, solved in the
/// solver's own steps. Its end is looked for in the dense output, inside steps too.
template <typename Solver>
class OdeintSlide {
 public:
  OdeintSlide(const PeerSled& forces, double tolerance)
      : forces_(forces), tolerance_(tolerance), stepper_(Solver::stepper(tolerance)) {}

  enum class End { kNone, kBeltSpeed, kNoForce };

  /// \param side  1 on a faster belt, −1 on a slower one. \param watches_force  Is c = 0 an end?
  void begin(double now_s, const State& x, double side, double belt_rate, bool watches_force) {
    start_s_ = now_s;
    side_ = side;
    belt_rate_ = belt_rate;
    taut_ = !forces_.one_way || x[0] > 0.0 || (x[0] == 0.0 && (x[1] > 0.0 || (x[1] == 0.0 && side > 0.0)));
    watches_force_ = watches_force;
    end_ = End::kNone;
    end_s_ = std::numeric_limits<double>::infinity();
    // What a method of order 5 is likely to take; the stepper finds its own from there.
    constexpr double kOrder = 5.0;
    stepper_.initialize(x, 0.0, std::pow(tolerance_, 1.0 / kOrder) / std::sqrt(forces_.omega0_squared));
  }

  /// Solves up to this time at least, or to the end.
  /// \return the end of this piece if it comes no later.
  End solve_until(double instant_s) {
    while (end_ == End::kNone && start_s_ + stepper_.current_time() < instant_s) {
      stepper_.do_step([this](const State& at, State& rate, double /*t*/) {
        rate = {at[1], acceleration(at)};
      });
      look_for_end();
    }
    return start_s_ + end_s_ <= instant_s ? end_ : End::kNone;
  }
  [[nodiscard]] double end_s() const { return start_s_ + end_s_; }
  /// \param instant_s  within the last step.
  [[nodiscard]] State at(double instant_s) { return state(instant_s - start_s_); }

 private:
  [[nodiscard]] double acceleration(const State& x) const {
    const double pull = taut_ ? -forces_.omega0_squared * x[0] - forces_.gamma * x[1] : 0.0;
    return pull + side_ * forces_.omega0_squared * forces_.K;
  }
  /// \param t_s  since the beginning.
  [[nodiscard]] State state(double t_s) {
    if (t_s <= 0.0 && stepper_.current_time() <= 0.0) return stepper_.current_state();
    State x{};
    stepper_.calc_state(t_s, x);
    return x;
  }
  /// How far c′ is past the belt's, and the derivative.
  [[nodiscard]] State past_belt(const State& x) const {
    return {side_ * (x[1] - belt_rate_), side_ * acceleration(x)};
  }
  /// How far c is past zero, and the derivative.
  [[nodiscard]] State past_zero(const State& x) const { return taut_ ? State{-x[0], -x[1]} : x; }

  void look_for_end() {
    const double from_s = stepper_.previous_time();
    const double to_s = stepper_.current_time();
    // Steps may be longer than an oscillation; a quarter of one has no more than one extreme.
    const double quarter_s = 0.5 * std::numbers::pi / std::sqrt(forces_.omega0_squared);
    const double looks = std::ceil((to_s - from_s) / quarter_s);
    double low_s = from_s;
    for (double look = 1.0; look <= looks && end_ == End::kNone; ++look) {
      const double high_s = look == looks ? to_s : from_s + (to_s - from_s) * look / looks;
      offer(End::kBeltSpeed, first_rise([this](const State& x) { return past_belt(x); }, low_s, high_s));
      if (watches_force_)
        offer(End::kNoForce, first_rise([this](const State& x) { return past_zero(x); }, low_s, high_s));
      low_s = high_s;
    }
  }

  void offer(End end, const std::optional<double>& t_s) {
    if (!t_s || *t_s >= end_s_) return;
    end_ = end;
    end_s_ = *t_s;
  }

  /// When a value first rises above zero, also if it falls back at once.
  template <typename Function>
  [[nodiscard]] std::optional<double> first_rise(const Function& value_and_slope, double low_s,
                                                 double high_s) {
    const auto value = [&](double t_s) { return value_and_slope(state(t_s))[0]; };
    const auto slope = [&](double t_s) { return value_and_slope(state(t_s))[1]; };
    const auto fall = [&](double t_s) { return -slope(t_s); };
    const double at_low = slope(low_s);
    const double at_high = slope(high_s);
    const double top_s = at_low > 0.0 && at_high < 0.0 ? sim::rise_between(fall, low_s, high_s) : high_s;
    if (!(value(top_s) > 0.0)) return std::nullopt;
    // A piece begins at zero, and falls.
    const double bottom_s = at_low < 0.0 && at_high > 0.0 ? sim::rise_between(slope, low_s, high_s) : low_s;
    return sim::rise_between(value, bottom_s, top_s);
  }

  PeerSled forces_;
  double tolerance_;
  decltype(Solver::stepper(0.0)) stepper_;
  double start_s_ = 0.0;
  double side_ = 1.0;
  double belt_rate_ = 0.0;
  bool taut_ = true;
  bool watches_force_ = false;
  End end_ = End::kNone;
  double end_s_ = 0.0;  ///< After the beginning.
};

template <typename Solver>
class Odeint final : public Method {
 public:
  explicit Odeint(double tolerance) : tolerance_(tolerance) {}

  [[nodiscard]] std::string_view name() const noexcept override { return Solver::kName; }
  [[nodiscard]] std::string setting() const override { return fmt::format("tolerance {:.0e}", tolerance_); }
  [[nodiscard]] std::string_view lacks(const Motion& motion) const noexcept override {
    return lacks_reference(motion);
  }
  RunOutcome run(const Motion& motion, double scan_rate_Hz, std::uint64_t /*seed*/,
                 std::span<double> coefficient) const override {
    Sled sled{motion, tolerance_};
    std::int64_t scan = 0;
    for (double& reading : coefficient) reading = sled.reading_at(static_cast<double>(scan++) / scan_rate_Hz);
    return {sled.captures, 0};
  }

 private:
  struct Sled {
    Sled(const Motion& motion, double tolerance)
        : forces(motion),
          belt(motion),
          slide(forces, tolerance),
          x{PeerSled::start_c(motion), PeerSled::start_rate(motion)} {
      belt_changed();
    }

    PeerSled forces;
    PlainBelt belt;
    OdeintSlide<Solver> slide;
    State x;  ///< Where the piece at hand began.
    double now_s = 0.0;
    double side = 1.0;  ///< Of the belt's speed on which the sled slides: 1 slower, −1 faster.
    bool sticks = true;
    std::int64_t captures = 0;

    double reading_at(double instant_s) {
      for (;;) {
        const double until_s = std::fmin(instant_s, belt.end_s());
        const bool ended = sticks ? stick_until(until_s) : slide_until(until_s);
        if (ended) continue;
        if (belt.end_s() > instant_s) break;
        x = state_at(until_s);
        now_s = until_s;
        belt.pass(now_s);
        belt_changed();
      }
      const double c = state_at(instant_s)[0];
      return forces.one_way ? std::fmax(c, 0.0) : c;
    }

    [[nodiscard]] State state_at(double instant_s) {
      if (!sticks) return slide.at(instant_s);
      return {x[0] + belt.rate() * (instant_s - now_s), belt.rate()};
    }

    void belt_changed() {
      if (belt.halts_when_unloaded() && x[0] <= 0.0) belt.halt();
      sticks = x[1] == belt.rate() && forces.holds(x[0], belt.rate());
      side = x[1] < belt.rate() ? 1.0 : -1.0;
      if (!sticks) begin_slide();
    }

    void begin_slide() {
      const bool halts = belt.halts_when_unloaded() && x[0] > 0.0;
      slide.begin(now_s, x, side, belt.rate(), forces.one_way || halts);
    }

    /// \return true if the piece ended.
    bool stick_until(double until_s) {
      const double rate = belt.rate();
      if (rate == 0.0) return false;
      const double limit = std::copysign(forces.S, rate) - forces.damper_share_s * rate;
      const bool slackens = forces.one_way && rate < 0.0;
      const double gives_way_s =
          slackens ? std::numeric_limits<double>::infinity() : now_s + (limit - x[0]) / rate;
      if (belt.halts_when_unloaded() && rate < 0.0) {
        const double unloaded_s = now_s - x[0] / rate;
        if (unloaded_s <= std::fmin(until_s, gives_way_s)) {
          x = {0.0, rate};
          now_s = unloaded_s;
          belt_changed();
          return true;
        }
      }
      if (!(gives_way_s <= until_s)) return false;
      x = {limit, rate};
      now_s = gives_way_s;
      sticks = false;
      side = rate > 0.0 ? 1.0 : -1.0;
      begin_slide();
      return true;
    }

    /// \return true if the piece ended.
    bool slide_until(double until_s) {
      using End = typename OdeintSlide<Solver>::End;
      const End end = slide.solve_until(until_s);
      if (end == End::kNone) return false;
      now_s = slide.end_s();
      x = slide.at(now_s);
      if (end == End::kNoForce) {
        x[0] = 0.0;
        if (belt.halts_when_unloaded()) {
          belt_changed();
        } else {
          begin_slide();
        }
        return true;
      }
      x[1] = belt.rate();
      captures += !forces.one_way || x[0] >= 0.0 ? 1 : 0;
      sticks = forces.holds(x[0], belt.rate());
      if (!sticks) {
        side = -side;
        begin_slide();
      }
      return true;
    }
  };

  double tolerance_;
};

}  // namespace

std::unique_ptr<Method> make_dormand_prince(double tolerance) {
  return std::make_unique<Odeint<DormandPrince>>(tolerance);
}
std::unique_ptr<Method> make_bulirsch_stoer(double tolerance) {
  return std::make_unique<Odeint<BulirschStoer>>(tolerance);
}

}  // namespace stickslip::accuracy

/// \file
/// SUNDIALS CVODE as an integrator that stops at events: the only wrapper of its headers.
///
///     Cvode integrator{Cvode::Method::kAdams, system, 2, 0.001};
///     integrator.set_tolerance({1e-9, 1e-9});
///     integrator.restart({0.3, 0.0});               // at t = 0
///     const Cvode::Step step = integrator.step();   // as far as CVODE likes to go at once
///     integrator.state_at(step.t_s / 2.0);          // anywhere in it
///
/// [Hindmarsh, Brown, Grant, Lee, Serban, Shumaker and Woodward, ACM TOMS 31(3):363–396, 2005]
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace stickslip::sim {

inline constexpr int kMaxOdeSize = 3;
inline constexpr int kMaxOdeEvents = 3;
/// State of a system; components beyond its size are ignored.
using OdeState = std::array<double, kMaxOdeSize>;

/// System of equations y′ = rate(t, y), with events where a function of t and y rises to zero.
class OdeSystem {
 public:
  struct Event {
    double value = -1.0;  ///< Below zero before the event; −1 for an unused event.
    double slope = 0.0;   ///< Derivative of `value` by time, per s; always 0: no extremes are sought.
    /// Expected error of `value` at an extreme; an extreme closer to zero counts in undecided_count().
    double doubt = 0.0;
  };
  using Events = std::array<Event, kMaxOdeEvents>;
  using Jacobian = std::array<OdeState, kMaxOdeSize>;  ///< [of which rate][by which variable]

  virtual ~OdeSystem() = default;
  [[nodiscard]] virtual OdeState rate(double t_s, const OdeState& y) const = 0;
  [[nodiscard]] virtual Jacobian jacobian(double t_s, const OdeState& y) const = 0;
  [[nodiscard]] virtual Events events(double t_s, const OdeState& y) const = 0;
};

/// Integrator with complete event detection. CVODE finds an event only if its sign differs at the ends of a
/// step. This class also finds one at an extreme inside the step, located where the slope changes its sign,
/// and one that is zero at the start and falls first. An extreme exactly at zero is an event. No event is
/// missed while steps (set_longest_step()) are not longer than the time between two extremes, unless its
/// slope is always 0.
///
/// Allocates when constructed; not afterwards, as far as CVODE itself does not. Thread-bound.
class Cvode {
 public:
  enum class Method {
    kAdams,  ///< Not stiff: orders 1 … 12, functional iteration.
    kBdf     ///< Stiff: orders 1 … 5, Newton with the system's Jacobian.
  };
  struct Step {
    double t_s = 0.0;                  ///< Solved up to here.
    std::optional<std::size_t> event;  ///< Index of the first event in the step, which is exactly at t_s.
  };

  /// \param system  outlives this. \param size  of its state, 1 … kMaxOdeSize.
  /// \param timescale_s > 0, from which CVODE finds its first step.
  Cvode(Method method, const OdeSystem& system, int size, double timescale_s);
  ~Cvode();
  Cvode(const Cvode&) = delete;
  Cvode& operator=(const Cvode&) = delete;

  /// Sets the absolute local error of each variable, > 0, that a step may have. Call before restart().
  void set_tolerance(const OdeState& tolerance);
  /// Sets the longest internal step, > 0; without a call there is no limit. restart() keeps it.
  void set_longest_step(double longest_s);

  /// Starts again at t = 0 with this state. Widened tolerances and the counts stay.
  void restart(const OdeState& state);

  /// Takes one internal step, or the part of it up to an event. There restart() begins another motion; only
  /// after an event whose slope is always 0 may the next call take the rest instead. If CVODE fails, it goes
  /// on from the last good point with ten times the tolerance, from then on. \throws std::runtime_error if it
  /// fails with 10⁶ times the tolerance too; then only restart() may follow.
  Step step();

  /// State inside the last step(), or at t = 0 right after restart(). \param t_s  is clipped to CVODE's step.
  [[nodiscard]] OdeState state_at(double t_s) const;

  /// Factor by which the tolerances were increased since construction; 1 without a failure.
  [[nodiscard]] double widened() const noexcept { return widened_; }
  /// Number of extremes since construction that were closer to zero than their doubt, so that an event may
  /// wrongly have been found or missed.
  [[nodiscard]] long undecided_count() const noexcept { return undecided_; }
  /// Number of steps since construction.
  [[nodiscard]] long step_count() const noexcept { return steps_; }

 private:
  struct Handles;
  struct Callbacks;

  void apply_tolerance();
  int attempt(double& t_s);
  [[nodiscard]] std::optional<double> missed_event(std::size_t event, double low, double high);
  void doubt_crossing(std::size_t event, double low, double crossing);
  [[nodiscard]] double extreme_between(std::size_t event, double low, double high) const;
  [[nodiscard]] OdeSystem::Event event_at(std::size_t event, double t_s) const;
  void store(const OdeState& state);
  [[nodiscard]] OdeState load() const;

  const OdeSystem& system_;
  int size_;
  double timescale_s_;
  OdeState tolerance_{};
  std::unique_ptr<Handles> handles_;
  double origin_s_ = 0.0;  ///< Of CVODE's clock, which starts anew where it had given up.
  double reached_s_ = 0.0;
  OdeState reached_{};
  double widened_ = 1.0;
  long steps_ = 0;
  long undecided_ = 0;
};

}  // namespace stickslip::sim

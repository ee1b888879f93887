/// \file
/// SUNDIALS CVODE as an integrator that stops at events: the only wrapper of its headers.
///
///     Cvode integrator{Cvode::Method::kAdams, system, 2};
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
/// Those beyond a system's size count for nothing.
using OdeState = std::array<double, kMaxOdeSize>;

/// y′ = rate(t, y), with events where a function of t and y rises to zero.
class OdeSystem {
 public:
  struct Event {
    double value = -1.0;  ///< Below zero before the event; one that is not wanted stays at −1.
    double slope = 0.0;   ///< Its derivative along the motion, 1/s
    /// Error to be expected of an extreme: one that is nearer to zero may be on either side.
    double doubt = 0.0;
  };
  using Events = std::array<Event, kMaxOdeEvents>;
  using Jacobian = std::array<OdeState, kMaxOdeSize>;  ///< [of which rate][by which variable]

  virtual ~OdeSystem() = default;
  [[nodiscard]] virtual OdeState rate(double t_s, const OdeState& y) const = 0;
  [[nodiscard]] virtual Jacobian jacobian(double t_s, const OdeState& y) const = 0;
  [[nodiscard]] virtual Events events(double t_s, const OdeState& y) const = 0;
};

/// CVODE looks for events only where their sign differs at the ends of a step. This class adds what it
/// misses: an extreme inside the step, found where the slope changes its sign, decides by the sign of the
/// event there; and an event that is zero at the start, from where it first falls. An extreme exactly at
/// zero counts. With steps no longer than the time between two extremes nothing is stepped over.
///
/// Allocates when constructed; not afterwards, if CVODE keeps its word. Thread-bound.
class Cvode {
 public:
  enum class Method {
    kAdams,  ///< Not stiff: orders 1 … 12, functional iteration.
    kBdf     ///< Stiff: orders 1 … 5, Newton with the system's Jacobian.
  };
  struct Step {
    double t_s = 0.0;                  ///< Solved up to here.
    std::optional<std::size_t> event;  ///< The first in the step, exactly at t_s.
  };

  /// \param system  outlives this. \param size  of its state. \param timescale_s > 0; of the first step.
  Cvode(Method method, const OdeSystem& system, int size, double timescale_s);
  ~Cvode();
  Cvode(const Cvode&) = delete;
  Cvode& operator=(const Cvode&) = delete;

  /// \param tolerance > 0, of each variable; the local error of a step. Holds from the next restart on.
  void set_tolerance(const OdeState& tolerance);
  void set_longest_step(double longest_s);

  /// At t = 0 again, with this state.
  void restart(const OdeState& state);

  /// One internal step, or the part of it up to an event; then the rest of it.
  /// Where CVODE gives up, it is started again from the last good point with ten times the tolerance.
  /// \throws std::runtime_error where even 10⁶ times the tolerance is of no use.
  Step step();

  /// \param t_s  within what the last step() has solved.
  [[nodiscard]] OdeState state_at(double t_s) const;

  /// By what the tolerances had to be widened so far; 1 if all went well.
  [[nodiscard]] double widened() const noexcept { return widened_; }
  /// Events, and events that did not happen, whose extreme was nearer to zero than its doubt; since
  /// construction.
  [[nodiscard]] long undecided_count() const noexcept { return undecided_; }
  /// Since construction.
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

#include "core/sim/cvode.hpp"

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/contract.hpp"
#include "core/sim/bracket.hpp"

namespace stickslip::sim {
namespace {

static_assert(sizeof(realtype) == sizeof(double));

/// What CVODE allocates, with what frees it.
template <typename Type, auto kFree>
struct Freed {
  void operator()(Type* pointer) const noexcept { (void)kFree(pointer); }
};

struct FreeContext {
  void operator()(SUNContext context) const noexcept { (void)SUNContext_Free(&context); }
};
struct FreeCvode {
  void operator()(void* memory) const noexcept { CVodeFree(&memory); }
};

using Context = std::unique_ptr<_SUNContext, FreeContext>;
using Vector = std::unique_ptr<_generic_N_Vector, Freed<_generic_N_Vector, N_VDestroy>>;
using Matrix = std::unique_ptr<_generic_SUNMatrix, Freed<_generic_SUNMatrix, SUNMatDestroy>>;
using LinearSolver =
    std::unique_ptr<_generic_SUNLinearSolver, Freed<_generic_SUNLinearSolver, SUNLinSolFree>>;
using NonlinearSolver =
    std::unique_ptr<_generic_SUNNonlinearSolver, Freed<_generic_SUNNonlinearSolver, SUNNonlinSolFree>>;

constexpr double kWidening = 10.0;
constexpr double kWidest = 1e6;

Context make_context() {
  SUNContext context = nullptr;
  STICKSLIP_EXPECTS(SUNContext_Create(nullptr, &context) == 0);
  return Context{context};
}

OdeState state_of(N_Vector vector) {
  OdeState state{};
  std::copy_n(N_VGetArrayPointer(vector), static_cast<std::size_t>(N_VGetLength(vector)), state.begin());
  return state;
}

}  // namespace

struct Cvode::Handles {
  Context context = make_context();
  Vector y;
  Vector tolerance;
  Matrix matrix;
  LinearSolver linear;
  NonlinearSolver nonlinear;
  std::unique_ptr<void, FreeCvode> cvode;  // Last: freed before what it uses.
};

struct Cvode::Callbacks {
  static const Cvode& self(void* user) { return *static_cast<const Cvode*>(user); }

  static int rate(realtype t, N_Vector y, N_Vector rate, void* user) {
    const Cvode& cvode = self(user);
    const OdeState value = cvode.system_.rate(cvode.origin_s_ + t, state_of(y));
    std::copy_n(value.begin(), cvode.size_, N_VGetArrayPointer(rate));
    // A step into nonsense is tried again, shorter.
    return std::all_of(value.begin(), value.begin() + cvode.size_, [](double x) { return std::isfinite(x); })
               ? 0
               : 1;
  }

  static int jacobian(realtype t, N_Vector y, N_Vector /*rate*/, SUNMatrix matrix, void* user,
                      N_Vector /*spare*/, N_Vector /*spare*/, N_Vector /*spare*/) {
    const Cvode& cvode = self(user);
    const OdeSystem::Jacobian value = cvode.system_.jacobian(cvode.origin_s_ + t, state_of(y));
    for (int row = 0; row < cvode.size_; ++row) {
      for (int column = 0; column < cvode.size_; ++column) {
        SM_ELEMENT_D(matrix, row, column) =
            value[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
      }
    }
    return 0;
  }

  static int events(realtype t, N_Vector y, realtype* values, void* user) {
    const Cvode& cvode = self(user);
    const OdeSystem::Events events = cvode.system_.events(cvode.origin_s_ + t, state_of(y));
    for (std::size_t i = 0; i < events.size(); ++i) values[i] = events[i].value;
    return 0;
  }

  /// Failures come back as return codes; CVODE need not print them too.
  static void silence(int /*code*/, const char* /*module*/, const char* /*function*/, char* /*message*/,
                      void* /*user*/) {}
};

Cvode::Cvode(Method method, const OdeSystem& system, int size, double timescale_s)
    : system_(system), size_(size), timescale_s_(timescale_s), handles_(std::make_unique<Handles>()) {
  STICKSLIP_EXPECTS(0 < size && size <= kMaxOdeSize && timescale_s > 0.0);
  const SUNContext context = handles_->context.get();
  handles_->y.reset(N_VNew_Serial(size, context));
  handles_->tolerance.reset(N_VNew_Serial(size, context));
  handles_->cvode.reset(CVodeCreate(method == Method::kAdams ? CV_ADAMS : CV_BDF, context));
  STICKSLIP_EXPECTS(handles_->y && handles_->tolerance && handles_->cvode);
  void* const cvode = handles_->cvode.get();
  N_VConst(0.0, handles_->y.get());
  N_VConst(1.0, handles_->tolerance.get());
  std::array<int, kMaxOdeEvents> rising{};
  rising.fill(1);
  int failed = CVodeInit(cvode, Callbacks::rate, 0.0, handles_->y.get());
  failed |= CVodeSetUserData(cvode, this);
  failed |= CVodeSetErrHandlerFn(cvode, Callbacks::silence, nullptr);
  failed |= CVodeSVtolerances(cvode, 0.0, handles_->tolerance.get());
  failed |= CVodeRootInit(cvode, kMaxOdeEvents, Callbacks::events);
  failed |= CVodeSetRootDirection(cvode, rising.data());
  failed |= CVodeSetNoInactiveRootWarn(cvode);
  failed |= CVodeSetMaxHnilWarns(cvode, -1);
  if (method == Method::kAdams) {
    handles_->nonlinear.reset(SUNNonlinSol_FixedPoint(handles_->y.get(), 0, context));
    failed |= CVodeSetNonlinearSolver(cvode, handles_->nonlinear.get());
  } else {
    handles_->matrix.reset(SUNDenseMatrix(size, size, context));
    handles_->linear.reset(SUNLinSol_Dense(handles_->y.get(), handles_->matrix.get(), context));
    failed |= CVodeSetLinearSolver(cvode, handles_->linear.get(), handles_->matrix.get());
    failed |= CVodeSetJacFn(cvode, Callbacks::jacobian);
    // Three by three at most: a fresh Jacobian costs less than an iteration with a stale one.
    failed |= CVodeSetLSetupFrequency(cvode, 1);
    failed |= CVodeSetNonlinConvCoef(cvode, 0.01);
    // After three failures CVODE predicts by the rate alone, which is that of the fastest decay: the step has
    // to come down to that before it passes, by many powers of ten if the system is very stiff.
    failed |= CVodeSetMaxErrTestFails(cvode, 100);
    failed |= CVodeSetMaxConvFails(cvode, 100);
  }
  STICKSLIP_EXPECTS(failed == CV_SUCCESS);
}

Cvode::~Cvode() = default;

void Cvode::set_tolerance(const OdeState& tolerance) {
  tolerance_ = tolerance;
  apply_tolerance();
}

void Cvode::apply_tolerance() {
  double* const values = N_VGetArrayPointer(handles_->tolerance.get());
  for (int i = 0; i < size_; ++i) values[i] = tolerance_[static_cast<std::size_t>(i)] * widened_;
  STICKSLIP_EXPECTS(CVodeSVtolerances(handles_->cvode.get(), 0.0, handles_->tolerance.get()) == CV_SUCCESS);
}

void Cvode::set_longest_step(double longest_s) {
  STICKSLIP_EXPECTS(CVodeSetMaxStep(handles_->cvode.get(), longest_s) == CV_SUCCESS);
}

void Cvode::store(const OdeState& state) {
  std::copy_n(state.begin(), size_, N_VGetArrayPointer(handles_->y.get()));
}

OdeState Cvode::load() const { return state_of(handles_->y.get()); }

void Cvode::restart(const OdeState& state) {
  origin_s_ = 0.0;
  reached_s_ = 0.0;
  reached_ = state;
  store(state);
  STICKSLIP_EXPECTS(CVodeReInit(handles_->cvode.get(), 0.0, handles_->y.get()) == CV_SUCCESS);
}

int Cvode::attempt(double& t_s) {
  const int code = CVode(handles_->cvode.get(), reached_s_ - origin_s_ + timescale_s_, handles_->y.get(),
                         &t_s, CV_ONE_STEP);
  t_s += origin_s_;
  return code;
}

Cvode::Step Cvode::step() {
  double t_s = 0.0;
  int code = attempt(t_s);
  while (code < 0) {
    if (widened_ * kWidening > kWidest) {
      throw std::runtime_error(
          fmt::format("CVODE cannot go on after {} s of a piece of the motion (code {})", reached_s_, code));
    }
    widened_ *= kWidening;
    apply_tolerance();
    origin_s_ = reached_s_;
    store(reached_);
    STICKSLIP_EXPECTS(CVodeReInit(handles_->cvode.get(), 0.0, handles_->y.get()) == CV_SUCCESS);
    code = attempt(t_s);
  }
  ++steps_;
  Step step{t_s, {}};
  if (code == CV_ROOT_RETURN) {
    std::array<int, kMaxOdeEvents> found{};
    CVodeGetRootInfo(handles_->cvode.get(), found.data());
    const auto* const first = std::find_if(found.begin(), found.end(), [](int sign) { return sign > 0; });
    if (first != found.end()) {
      step.event = static_cast<std::size_t>(first - found.begin());
      doubt_crossing(*step.event, reached_s_, step.t_s);
    }
  }
  for (std::size_t event = 0; event < kMaxOdeEvents; ++event) {
    if (step.event == event) continue;
    const std::optional<double> missed_s = missed_event(event, reached_s_, step.t_s);
    if (missed_s) step = {*missed_s, event};
  }
  reached_s_ = step.t_s;
  reached_ = state_at(step.t_s);
  return step;
}

OdeSystem::Event Cvode::event_at(std::size_t event, double t_s) const {
  return system_.events(t_s, state_at(t_s))[event];
}

double Cvode::extreme_between(std::size_t event, double low, double high) const {
  const double sign = event_at(event, low).slope > 0.0 ? -1.0 : 1.0;
  return rise_between([&](double t_s) { return sign * event_at(event, t_s).slope; }, low, high);
}

/// How far beyond zero the extreme lies that follows a crossing: a parabola through its slope and bend.
void Cvode::doubt_crossing(std::size_t event, double low, double crossing) {
  const OdeSystem::Event at = event_at(event, crossing);
  const double bend = (at.slope - event_at(event, low).slope) / (crossing - low);
  if (bend < 0.0 && at.slope * at.slope < -2.0 * bend * at.doubt) ++undecided_;
}

std::optional<double> Cvode::missed_event(std::size_t event, double low, double high) {
  const OdeSystem::Event first = event_at(event, low);
  const OdeSystem::Event last = event_at(event, high);
  double from = low;
  double to = high;
  if (first.slope > 0.0 && last.slope < 0.0 && first.value < 0.0) {
    to = extreme_between(event, low, high);
    const OdeSystem::Event extreme = event_at(event, to);
    if (std::abs(extreme.value) < extreme.doubt) ++undecided_;
    if (extreme.value < 0.0) return std::nullopt;
  } else if (first.value == 0.0 && first.slope < 0.0 && last.value > 0.0) {
    from = extreme_between(event, low, high);
  } else {
    return std::nullopt;
  }
  return rise_between([&](double t_s) { return event_at(event, t_s).value; }, from, to);
}

OdeState Cvode::state_at(double t_s) const {
  if (t_s == reached_s_) {
    // Also right before the first step, when there is nothing to interpolate in.
    long steps = 0;
    CVodeGetNumSteps(handles_->cvode.get(), &steps);
    if (steps == 0) return reached_;
  }
  // Sums of times are rounded, and CVODE is strict about the ends of its step.
  double end_s = 0.0;
  double last_step_s = 0.0;
  CVodeGetCurrentTime(handles_->cvode.get(), &end_s);
  CVodeGetLastStep(handles_->cvode.get(), &last_step_s);
  const double inside_s = std::clamp(t_s - origin_s_, end_s - last_step_s, end_s);
  STICKSLIP_EXPECTS(CVodeGetDky(handles_->cvode.get(), inside_s, 0, handles_->y.get()) == CV_SUCCESS);
  return load();
}

}  // namespace stickslip::sim

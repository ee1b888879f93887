#include <fmt/format.h>

#include <cmath>

#include "core/accuracy/method.hpp"
#include "core/sim/numeric_solver.hpp"
#include "core/sim/propagator.hpp"

namespace stickslip::accuracy {
namespace {

class Captures final : public sim::MotionObserver {
 public:
  void mode_began(const sim::ModeStart& start) override { count_ += start.capture ? 1 : 0; }
  [[nodiscard]] std::int64_t count() const noexcept { return count_; }

 private:
  std::int64_t count_ = 0;
};

class Exact final : public Method {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "exact closed forms"; }
  [[nodiscard]] std::string setting() const override { return {}; }
  [[nodiscard]] std::string_view lacks(const sim::Motion& motion) const noexcept override {
    return sim::has_closed_form(motion) ? std::string_view{} : "friction has no closed form";
  }
  RunOutcome run(const sim::Motion& motion, double scan_rate_Hz, std::uint64_t seed,
                 std::span<double> coefficient) const override {
    Captures captures;
    sim::Propagator{motion, scan_rate_Hz, &captures, seed}.next(coefficient);
    return {captures.count(), 0};
  }
};

class Cvode final : public Method {
 public:
  explicit Cvode(double accuracy) : accuracy_(accuracy) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "CVODE with grazing test"; }
  [[nodiscard]] std::string setting() const override { return fmt::format("accuracy {:.0e}", accuracy_); }
  [[nodiscard]] std::string_view lacks(const sim::Motion& /*motion*/) const noexcept override { return {}; }
  RunOutcome run(const sim::Motion& motion, double scan_rate_Hz, std::uint64_t seed,
                 std::span<double> coefficient) const override {
    Captures captures;
    sim::NumericSolver sled{motion, scan_rate_Hz, accuracy_, &captures, seed};
    sled.next(coefficient);
    return {captures.count(), sled.method().undecided_count};
  }

 private:
  double accuracy_;
};

}  // namespace

std::unique_ptr<Method> make_cvode(double accuracy) { return std::make_unique<Cvode>(accuracy); }
std::unique_ptr<Method> make_exact() { return std::make_unique<Exact>(); }

std::vector<std::unique_ptr<Method>> shipped_methods() {
  std::vector<std::unique_ptr<Method>> methods;
  methods.push_back(make_exact());
  for (int digits = 3; digits <= 12; ++digits) methods.push_back(make_cvode(std::pow(10.0, -digits)));
  for (const auto make : {make_dormand_prince, make_bulirsch_stoer}) {
    for (int digits = 3; digits <= 13; digits += 2) methods.push_back(make(std::pow(10.0, -digits)));
  }
  for (const int steps : {1, 4, 16, 64, 256, 1024}) methods.push_back(make_euler(steps));
  for (const double width : {0.1, 0.03, 0.01, 0.003}) methods.push_back(make_tanh(width));
  return methods;
}

}  // namespace stickslip::accuracy

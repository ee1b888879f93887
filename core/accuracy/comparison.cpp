#include "core/accuracy/comparison.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/accuracy/least_time.hpp"
#include "core/accuracy/reference.hpp"
#include "core/base/contract.hpp"
#include "core/sim/numeric_solver.hpp"

namespace stickslip::accuracy {
namespace {

/// Accuracies of the CVODE run that serves as reference, and of the run that it is compared with.
constexpr double kTightest = 1e-12;
constexpr double kNextTightest = 1e-11;

struct Truth {
  std::string name;
  double uncertainty = 0.0;
  std::int64_t capture_count = 0;
  std::vector<double> coefficient;
};

Truth truth_of(const MotionCase& scene) {
  Truth truth;
  truth.coefficient.resize(static_cast<std::size_t>(scene.scan_count));
  if (lacks_reference(scene.motion).empty()) {
    Reference reference{scene.motion, scene.scan_rate_Hz};
    reference.next(truth.coefficient);
    truth.name = "closed forms in 50 digits";
    truth.uncertainty = std::numeric_limits<double>::epsilon();  // Read as a double.
    truth.capture_count = reference.capture_count();
    return truth;
  }
  const auto solve = [&scene](double accuracy, std::span<double> coefficient) {
    return make_cvode(accuracy)->run(scene.motion, scene.scan_rate_Hz, scene.seed, coefficient).capture_count;
  };
  std::vector<double> next_tightest(truth.coefficient.size());
  (void)solve(kNextTightest, next_tightest);
  truth.capture_count = solve(kTightest, truth.coefficient);
  // At its floor CVODE takes the same steps whatever is asked: no difference is then no certainty.
  const double in_use = sim::NumericSolver{scene.motion, scene.scan_rate_Hz, kTightest}.method().accuracy;
  truth.uncertainty = std::fmax(in_use, largest_difference(truth.coefficient, next_tightest));
  truth.name = fmt::format("CVODE at {:.0e}, since {}", kTightest, lacks_reference(scene.motion));
  return truth;
}

void measure(const Method& method, const MotionCase& scene, const Truth& truth, const base::Clock& clock,
             MethodMeasurement& row) {
  std::vector<double> coefficient(truth.coefficient.size());
  const std::int64_t time_ns = least_time_ns(clock, [&] {
    row.capture_count = method.run(scene.motion, scene.scan_rate_Hz, scene.seed, coefficient).capture_count;
  });
  row.ns_per_scan = static_cast<double>(time_ns) / static_cast<double>(scene.scan_count);
  // The reference itself, or steps that its tolerance, at the floor of what CVODE can do, shares with it.
  const bool is_reference = !lacks_reference(scene.motion).empty() && coefficient == truth.coefficient;
  if (!is_reference) row.largest_error = largest_difference(coefficient, truth.coefficient);
}

}  // namespace

double largest_difference(std::span<const double> a, std::span<const double> b) {
  STICKSLIP_EXPECTS(a.size() == b.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = std::abs(a[i] - b[i]);
    if (!std::isfinite(difference)) return std::numeric_limits<double>::infinity();
    largest = std::fmax(largest, difference);
  }
  return largest;
}

std::optional<double> MotionComparison::exact_ns_per_scan() const {
  for (const MethodMeasurement& row : rows) {
    if (row.method == make_exact()->name() && row.lacks.empty()) return row.ns_per_scan;
  }
  return std::nullopt;
}

MotionComparison compare_motion(const MotionCase& motion_case,
                                std::span<const std::unique_ptr<Method>> methods, const base::Clock& clock,
                                const Progress& progress) {
  STICKSLIP_EXPECTS(motion_case.scan_count > 0);
  const Truth truth = truth_of(motion_case);
  MotionComparison comparison{truth.name, truth.uncertainty, truth.capture_count, {}};
  for (const std::unique_ptr<Method>& method : methods) {
    if (progress) {
      progress(static_cast<double>(comparison.rows.size()) / static_cast<double>(methods.size()));
    }
    MethodMeasurement row;
    row.method = method->name();
    row.setting = method->setting();
    row.lacks = method->lacks(motion_case.motion);
    if (row.lacks.empty()) {
      try {
        measure(*method, motion_case, truth, clock, row);
      } catch (const std::runtime_error& gave_up) {  // CVODE may.
        row.lacks = gave_up.what();
      }
    }
    comparison.rows.push_back(std::move(row));
  }
  if (progress) progress(1.0);
  return comparison;
}

}  // namespace stickslip::accuracy

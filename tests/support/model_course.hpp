/// \file
/// Traces made of the closed-form model itself: regular sticks and slips, or one ring-down, with or
/// without white noise. What the fits are asked to give back.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "core/estimate/slip_fit.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/capture.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::test {

/// The paper's tester at a dimensionless speed Q, with S = 0.35 and K = 0.30.
struct ModelCourse {
  model::SharedParameters shared;
  std::vector<estimate::SlipWindow> windows;  ///< With the true parameters.
  estimate::Trace trace;                      ///< Without noise.

  static constexpr double kOmega = 2.0 * std::numbers::pi * 20.0;
  static constexpr double kGammaOver2Omega = 0.022;
  static constexpr double kS = 0.35;
  static constexpr double kK = 0.30;
  static constexpr double kScanRate_Hz = 350.0;
  /// Where the first slip begins: neither on a scan nor half way between two.
  static constexpr double kFirstOnset_s = 20.3 / kScanRate_Hz;

  [[nodiscard]] static model::SharedParameters tester_at(double Q) {
    return {kOmega, 2.0 * kGammaOver2Omega * kOmega, Q * kOmega * (kS - kK)};
  }

  /// `slips` slips that each end in sticking; only where the model sticks again, Q < Q_th.
  [[nodiscard]] static ModelCourse captured(double Q, int slips) {
    ModelCourse course;
    course.shared = tester_at(Q);
    double onset_s = kFirstOnset_s;
    double window_begin_s = 0.0;
    for (int i = 0; i < slips; ++i) {
      estimate::SlipWindow window;
      window.captured = true;
      window.slip = {onset_s, kS, kK};
      const model::SlipModel model{course.shared, window.slip, true};
      const double capture_s = onset_s + model.capture_s();
      const double at_capture = model.at(capture_s).value;
      onset_s = capture_s + (kS - at_capture) / course.shared.r;
      const double window_end_s = 0.5 * (capture_s + onset_s);
      window.first = scan_after(window_begin_s);
      window.end = scan_after(window_end_s);
      window_begin_s = window_end_s;
      course.windows.push_back(window);
    }
    course.fill();
    return course;
  }

  /// One slip and what follows for so many periods.
  [[nodiscard]] static ModelCourse free(double Q, double periods) {
    ModelCourse course;
    course.shared = tester_at(Q);
    estimate::SlipWindow window;
    window.slip = {kFirstOnset_s, kS, kK};
    window.end = scan_after(kFirstOnset_s + periods * 2.0 * std::numbers::pi / kOmega);
    course.windows.push_back(window);
    course.fill();
    return course;
  }

  /// The same with white noise.
  [[nodiscard]] estimate::Trace noisy(double sigma, std::uint64_t seed) const {
    std::mt19937_64 engine{seed};
    std::normal_distribution<double> normal{0.0, sigma};
    estimate::Trace result = trace;
    for (double& value : result.value) value += normal(engine);
    return result;
  }

 private:
  [[nodiscard]] static std::size_t scan_after(double time_s) {
    return static_cast<std::size_t>(std::ceil(time_s * kScanRate_Hz));
  }

  void fill() {
    for (const estimate::SlipWindow& window : windows) {
      const model::SlipModel model{shared, window.slip, window.captured};
      for (std::size_t k = window.first; k < window.end; ++k) {
        trace.time_s.push_back(static_cast<double>(k) / kScanRate_Hz);
        trace.value.push_back(model.at(trace.time_s.back()).value);
        trace.usable.push_back(1);
      }
    }
  }
};

}  // namespace stickslip::test

#include "core/detect/quick_junction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/estimate/sampling.hpp"

namespace stickslip::detect {
namespace {

/// Rows a period; the result hardly depends on it within a factor of two.
constexpr double kQuickRowsPerPeriod = 24.0;
/// Fewest rows for a decision.
constexpr double kFewestRowsToChoose = 8.0;
/// Possible difference of the log-likelihood ratio from that of a fit with Huber's weights.
constexpr double kSlack = 1.0;
/// Cost of a row that is hardly ever exceeded, log-likelihood units: that of two standard deviations.
constexpr double kUsualOfRow = 2.0;
/// Limit of the scans in a row, against invalid numbers.
constexpr double kMostScansARow = 1e6;

/// Lines under −ln(e^{−a} + kStrayDensity), which says how little a free course explains a scan with a =
/// z²/2: concave, so the chords of its values at these a lie below, and each beyond its ends above.
class Unexplained {
 public:
  Unexplained() noexcept {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const double slope = (at(kKnots[i + 1]) - at(kKnots[i])) / (kKnots[i + 1] - kKnots[i]);
      lines_[i] = {at(kKnots[i]) - slope * kKnots[i], slope};
    }
    most_ = at(kKnots.back());
    least_told_ = std::log(kStrayDensity);
  }
  /// ln kStrayDensity: a scan that a course does not explain.
  [[nodiscard]] double least_told() const noexcept { return least_told_; }
  /// \param half_squares  an array of a. \return the same of not more than that each: an expression.
  template <typename Array>
  [[nodiscard]] auto operator()(const Array& half_squares) const noexcept {
    const auto line = [&](std::size_t i) { return lines_[i].slope * half_squares + lines_[i].at_zero; };
    return line(0).min(line(1)).min(line(2)).min(line(3)).min(line(4)).min(most_);
  }

 private:
  struct Line {
    double at_zero;
    double slope;
  };
  static double at(double half_square) noexcept { return -std::log(std::exp(-half_square) + kStrayDensity); }

  static constexpr std::array<double, 6> kKnots{0.0, 2.0, 3.5, 5.0, 7.0, 10.0};
  std::array<Line, kKnots.size() - 1> lines_{};
  double most_ = 0.0;
  double least_told_ = 0.0;
};

}  // namespace

void QuickJunction::gap() noexcept {
  rows_.restart(rows_.scans_per_row());
  open_ = false;
}

void QuickJunction::fit_rows(double omega) noexcept {
  const double fitting = 2.0 * std::numbers::pi / (omega * kQuickRowsPerPeriod * rows_.scan_s());
  const std::size_t scans =
      fitting >= 1.0 && fitting < kMostScansARow ? static_cast<std::size_t>(fitting) : 1;
  if (scans <= 2 * rows_.scans_per_row() && rows_.scans_per_row() <= 2 * scans) return;
  rows_.restart(scans);
  captured_ = {};  // Its rows are others.
}

void QuickJunction::open(double now_s, double peak_s, double level,
                         const model::SharedParameters& shared) noexcept {
  fitted_ = false;
  // With few scans a period there are few rows beside those that four parameters need.
  const double period_s = 2.0 * std::numbers::pi / shared.omega;
  open_ = period_s >= estimate::kFewScansACycle * rows_.scan_s() &&
          slip_.begin(rows_, now_s, peak_s, level, shared);
}

std::optional<QuickJunction::Answer> QuickJunction::fit_capture(const Free& free, double decisive) noexcept {
  const auto start = [&](std::size_t row) {
    return captured_.start(slip_, row, typical_delta_mu_, row_variance_);
  };
  // Where the last one was, or else by the free course.
  Crossing crossing = Crossing::kNever;
  if (const std::size_t row = captured_.stick().row; row > slip_.half() && row + 1 < slip_.size())
    crossing = start(row);
  if (crossing != Crossing::kThere) {
    StickBegin begin;
    crossing = find_stick(slip_, free.course, begin);
    if (crossing == Crossing::kThere) crossing = start(begin.row);
  }
  if (crossing == Crossing::kToCome) return Answer::kNotYet;
  if (crossing == Crossing::kNever) return ask_escaped(free, decisive);
  fitted_ = true;
  captured_size_ = fitted_size_ = slip_.size();
  captured_cost_ = captured_.cost();
  return std::nullopt;
}

QuickJunction::Answer QuickJunction::ask_escaped(const Free& free, double decisive) noexcept {
  // What a captured course costs at least, nearly: the rows before the end of the rise of c′, and that c′
  // falls short of r there (20). One that reaches r costs more of these rows.
  const std::size_t last = std::min(find_rise_end(slip_, free.course).row, slip_.size() - 1);
  if (slip_.sums(last).n < kFewestRowsToChoose) return Answer::kNotYet;
  const auto [course, square_sum] = slip_.fit(last);
  const RiseEnd end = find_rise_end(slip_, course);
  const double r = slip_.shared().r;
  if (!(end.rate < r)) return Answer::kDoubt;
  // c′ is stationary there, so that a shift of the moment drops out.
  const RowCourse by{0.0, slip_.motion({0.0, 1.0, 0.0}, end.basis).rate,
                     slip_.motion({0.0, 0.0, 1.0}, end.basis).rate};
  const double spread = kStickRateSpread * r;
  const double variance = spread * spread + row_variance_ * slip_.variance(last, by);
  const double shortfall = r - end.rate;
  const double captured_cost = 0.5 * (square_sum / row_variance_ + shortfall * shortfall / variance);
  const double ratio = free.cost - captured_cost;
  if (!(ratio < -(decisive + kSlack)) || has_stray(free.course)) return Answer::kDoubt;
  evidence_ = {};
  evidence_.known = true;
  evidence_.log_likelihood_ratio = ratio;
  evidence_.residual_sigmas = std::sqrt(2.0 * free.cost / slip_.sums(slip_.size() - 1).n);
  return Answer::kFree;
}

bool QuickJunction::has_stray(const RowCourse& free) const noexcept {
  const double most = kChoiceLimit * kChoiceLimit * row_variance_;
  return (slip_.weights() * slip_.off(free, slip_.size()).square()).maxCoeff() > most;
}

void QuickJunction::add_new_rows() noexcept {
  const double r = slip_.shared().r;
  for (; captured_size_ < slip_.size(); ++captured_size_) {
    const double tau_s = slip_.tau_s(captured_size_);
    double value = captured_.line(tau_s, r);
    if (const double after_s = tau_s - captured_.onset_tau_s(); after_s > 0.0) {
      const auto rows = static_cast<std::size_t>(after_s / slip_.row_s());
      TurnedBasis b = slip_.later({}, after_s - slip_.tau_s(rows));
      for (std::size_t i = 0; i < rows; ++i) b = slip_.a_row_later(b);
      value = captured_.next_slip(slip_, b);
    }
    const double off = slip_.value(captured_size_) - value;
    captured_cost_ += 0.5 * slip_.weight(captured_size_) * off * off / row_variance_;
  }
}

bool QuickJunction::improve(const Free& free, double decisive) noexcept {
  // A course that costs as much for some rows costs no less for more of them, and at most what it costs as it
  // is.
  const double as_usual = captured_.cost() + kUsualOfRow * static_cast<double>(captured_size_ - fitted_size_);
  const double enough = std::min(free.cost - decisive - kSlack, as_usual);
  const bool may_be_captured = free.cost - captured_.cost() > decisive;
  const bool may_be_free = captured_cost_ - free.cost >= decisive - kSlack;
  if (!may_be_free && !(may_be_captured && captured_cost_ > enough)) return true;
  if (fitted_size_ != slip_.size() && captured_.update(slip_) != Crossing::kThere) return false;
  captured_.improve(slip_, enough);
  fitted_size_ = slip_.size();
  captured_cost_ = captured_.cost();
  return true;
}

double QuickJunction::told(const RowCourse& free_course, double scale, double decisive) const noexcept {
  static const Unexplained unexplained;
  using Rows = Eigen::Array<double, Eigen::Dynamic, 1, 0, SlipRows::kMost, 1>;
  const std::size_t size = slip_.size();
  const Rows free = 0.5 * scale * slip_.weights() * slip_.off(free_course, size).square();
  const double unusual = 0.5 * captured_.unusual() * captured_.unusual();
  // Strays of the captured course cost no more than one scan can; where all they cost leaves it decided, none
  // is looked for.
  const double at_least =
      unexplained(free).sum() - (captured_cost_ - unusual) * row_variance_ * scale - unusual;
  if (at_least > decisive) return at_least;
  Rows captured_off(size);
  const std::size_t before = captured_.stick().row + 1;
  captured_off.head(static_cast<Eigen::Index>(before)) = slip_.off(captured_.slip(), before);
  const auto leave = [&](std::size_t k, double value, const TurnedBasis& = {}) {
    captured_off(static_cast<Eigen::Index>(k)) = slip_.value(k) - value;
  };
  captured_.for_each_behind(slip_, leave, leave);
  const double by_rows =
      (unexplained(free) +
       (-0.5 * scale * slip_.weights() * captured_off.square()).max(unexplained.least_told()))
          .sum();
  return by_rows - unusual;
}

QuickJunction::Answer QuickJunction::ask(double sigma, double typical_delta_mu, double decisive,
                                         double until_s) noexcept {
  if (open_) open_ = slip_.take(rows_, until_s);
  if (!open_ || slip_.size() == 0) return Answer::kDoubt;
  const std::size_t last = slip_.size() - 1;
  const double count = slip_.sums(last).n;
  if (count < kFewestRowsToChoose) return Answer::kNotYet;
  const double row_variance = sigma * sigma / static_cast<double>(rows_.scans_per_row());
  if (row_variance != row_variance_ || typical_delta_mu != typical_delta_mu_) {
    row_variance_ = row_variance;
    typical_delta_mu_ = typical_delta_mu;
    fitted_ = false;
  }
  const auto [course, square_sum] = slip_.fit(last);
  const Free free{course, 0.5 * square_sum / row_variance};
  if (!fitted_) {
    if (const auto answer = fit_capture(free, decisive)) return *answer;
  } else {
    add_new_rows();
  }
  if (!improve(free, decisive)) {
    fitted_ = false;
    return ask_escaped(free, decisive);
  }
  const double ratio = free.cost - captured_cost_;
  const double residual_square = 2.0 * std::min(free.cost, captured_cost_) / count;
  if (residual_square > kMisfitSigmas * kMisfitSigmas || ratio <= -(decisive - kSlack)) return Answer::kDoubt;
  if (!(ratio > decisive)) return Answer::kNotYet;
  const double ratio_told = told(course, 1.0 / (row_variance * std::max(residual_square, 1.0)), decisive);
  if (!(ratio_told > decisive)) return Answer::kNotYet;
  evidence_.known = true;
  evidence_.log_likelihood_ratio = ratio_told;
  evidence_.residual_sigmas = std::sqrt(residual_square);
  evidence_.capture_s = slip_.first_s() + captured_.stick().tau_s;
  evidence_.next_onset_s = slip_.first_s() + captured_.onset_tau_s();
  return Answer::kCaptured;
}

}  // namespace stickslip::detect

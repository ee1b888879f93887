#include "core/friction/live_junction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "core/friction/capture.hpp"
#include "core/friction/damping.hpp"
#include "core/friction/huber.hpp"
#include "core/friction/junction.hpp"

namespace stickslip::friction {
namespace {

/// Rows of a question: forty a period, whose blocks differ from their curvature term by less than 10⁻⁵ of the
/// amplitude, and which have the same scans at the next question.
constexpr double kRowsPerPeriod = 40.0;
/// Density, over that of noise at its middle, of scans that no course explains: one in twenty is a spike that
/// was not found, anywhere within the ±6 σ that the despiker lets pass. −ln of it, 4.6, is the most that a
/// scan tells: two strays cannot decide, three seldom meet.
constexpr double kStrayDensity = 0.01;
/// Of so many rows one may be left out, and of all no more than three: more are no strays, but neither
/// course.
constexpr std::size_t kRowsPerStray = 5;
constexpr std::size_t kMostStrays = 3;
/// Four parameters, and a choice.
constexpr std::size_t kFewestRows = 8;
/// Of reweighting: weights of a linear model settle in two or three rounds.
constexpr int kLiveRounds = 3;
constexpr int kMostLiveIterations = 8;
/// Log-likelihood units: nothing against what decides.
constexpr double kLiveConverged = 1e-2;
/// By so much the bounds may be wrong: what reweighting leaves of its way to the least cost.
constexpr double kBoundsSlack = 1.0;

/// −ln of the likelihood of a scan that is z off, with noise or a stray.
double mixture_cost(double z) noexcept { return -std::log(std::exp(-0.5 * z * z) + kStrayDensity); }

}  // namespace

LiveJunction::Row LiveJunction::row_of(std::span<const CyclePoint> together, double first_s,
                                       const SharedParameters& shared) noexcept {
  const auto& [omega, gamma, r] = shared;
  const double omega0_squared = omega * omega + 0.25 * gamma * gamma;
  Row sum;
  double count = 0.0;
  double squares = 0.0;  // Of times, for the spread of all scans together.
  for (const CyclePoint& point : together) {
    const double tau_s = point.time_s - first_s;
    const double decay = std::exp(-0.5 * gamma * tau_s);
    const double cosine = decay * std::cos(omega * tau_s);
    const double sine = decay * std::sin(omega * tau_s) / omega;
    const double by_D = cosine + 0.5 * gamma * sine;
    // Both solve f″ = −γ f′ − ω₀² f; the first has f′ = −ω₀² sine, the second cosine − γ/2 sine.
    const double rate_by_D = -omega0_squared * sine;
    const double rate_by_rate = cosine - 0.5 * gamma * sine;
    const double half_s2 = 0.5 * point.spread_s2;
    sum.tau_s += point.count * tau_s;
    sum.value += point.count * point.value;
    sum.by_D += point.count * (by_D + half_s2 * (-gamma * rate_by_D - omega0_squared * by_D));
    sum.by_rate += point.count * (sine + half_s2 * (-gamma * rate_by_rate - omega0_squared * sine));
    squares += point.count * (tau_s * tau_s + point.spread_s2);
    count += point.count;
  }
  Row row;
  row.tau_s = sum.tau_s / count;
  row.value = sum.value / count;
  row.by_D = sum.by_D / count;
  row.by_rate = sum.by_rate / count;
  row.root_count = std::sqrt(count);
  row.half_spread_s2 = 0.5 * std::max(squares / count - row.tau_s * row.tau_s, 0.0);
  row.begin_s = together.front().time_s;
  row.end_s = together.back().time_s;
  return row;
}

void LiveJunction::lay_out(std::span<const CyclePoint> points, const SharedParameters& shared,
                           double sigma) noexcept {
  const double first_s = points.front().time_s;
  const bool same_courses =
      first_s == first_s_ && shared.omega == shared_.omega && shared.gamma == shared_.gamma;
  const std::size_t before = same_courses ? size_ : 0;
  const double rows_per_s = kRowsPerPeriod * shared.omega / (2.0 * std::numbers::pi);
  const auto place = [&](const CyclePoint& point) {
    return std::floor((point.time_s - first_s) * rows_per_s);
  };
  size_ = 0;
  std::size_t unchanged = 0;
  for (auto begin = points.begin(); begin != points.end();) {
    const double here = place(*begin);
    const auto end =
        std::find_if(begin + 1, points.end(), [&](const CyclePoint& point) { return place(point) != here; });
    Row& row = rows_[size_];
    // The scans that were there last time.
    if (size_ < before && row.begin_s == begin->time_s && row.end_s == (end - 1)->time_s) {
      if (unchanged == size_) ++unchanged;
    } else {
      row = row_of({begin, end}, first_s, shared);
    }
    ++size_;
    begin = end;
  }
  if (!(same_courses && sigma == sigma_ && unchanged >= common_count_)) common_count_ = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    // What strays from the common course does so until that is fitted anew.
    rows_[i].stray = rows_[i].stray && i < common_count_;
    rows_[i].scale = rows_[i].stray ? 0.0 : rows_[i].root_count / sigma;
  }
  first_s_ = first_s;
  shared_ = shared;
  sigma_ = sigma;
}

double LiveJunction::fit_free(std::size_t count, Free& p) const noexcept {
  double cost = 0.0;
  for (int round = 0; round <= kLiveRounds; ++round) {
    // Written out: three numbers make poor vectors.
    double n00 = 0.0;
    double n01 = 0.0;
    double n02 = 0.0;
    double n11 = 0.0;
    double n12 = 0.0;
    double n22 = 0.0;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    cost = 0.0;
    for (const Row& row : rows().first(count)) {
      const double z = free_residual(row, p);
      cost += huber_cost(z, kChoiceLimit);
      const double weight = (round == 0 ? 1.0 : huber_weight(z, kChoiceLimit)) * row.scale * row.scale;
      const double weighted_D = weight * row.by_D;
      const double weighted_rate = weight * row.by_rate;
      n00 += weight;
      n01 += weighted_D;
      n02 += weighted_rate;
      n11 += weighted_D * row.by_D;
      n12 += weighted_rate * row.by_D;
      n22 += weighted_rate * row.by_rate;
      const double weighted_value = weight * row.value;
      right[0] += weighted_value;
      right[1] += weighted_value * row.by_D;
      right[2] += weighted_value * row.by_rate;
    }
    if (round == kLiveRounds) break;
    Eigen::Matrix3d normal;
    normal << n00, n01, n02, n01, n11, n12, n02, n12, n22;
    // by_rate is smaller than the others by ω: its own unit.
    const Eigen::Vector3d scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::Vector3d next = scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(right)));
    if (next.allFinite()) p = next;
  }
  return cost;
}

template <typename SigmasOff>
bool LiveJunction::leave_out_a_stray(std::span<Row> among, SigmasOff sigmas_off) noexcept {
  Row* farthest = nullptr;
  double off = kStraySigmas;
  std::size_t left_out = 1;
  for (Row& row : among) {
    if (row.stray) ++left_out;
    if (const double z = std::abs(sigmas_off(row)); z > off) {
      off = z;
      farthest = &row;
    }
  }
  if (farthest == nullptr || left_out > kMostStrays || kRowsPerStray * left_out > size_) return false;
  farthest->stray = true;
  farthest->scale = 0.0;
  return true;
}

bool LiveJunction::leave_out_a_stray_of_both(const Courses& courses,
                                             const SharedParameters& shared) noexcept {
  const Events events = events_of(courses.captured, shared);
  return leave_out_a_stray(std::span{rows_}.first(size_).subspan(common_count_), [&](const Row& row) {
    const double captured =
        (row.value - captured_at(row, courses.captured, events, shared).value) * row.scale;
    return std::min(std::abs(free_residual(row, courses.free)), std::abs(captured));
  });
}

void LiveJunction::fit_common(const SharedParameters& shared, double typical_delta_mu) noexcept {
  // Up to the trough, half an oscillation after the peak, the two are the same course.
  const double half_s = std::numbers::pi / shared.omega;
  std::size_t same = 0;
  while (same < size_ && rows_[same].tau_s < half_s) ++same;
  const std::size_t count = std::max<std::size_t>(std::min(size_, same), 4);
  if (count == common_count_ && typical_delta_mu == common_typical_ && shared.r == common_r_) return;
  common_count_ = count;
  common_typical_ = typical_delta_mu;
  common_r_ = shared.r;
  for (Row& row : std::span{rows_}.first(count)) {
    row.stray = false;
    row.scale = row.root_count / sigma_;
  }
  common_ = Free::Zero();
  do {
    common_cost_ = fit_free(count, common_);
  } while (leave_out_a_stray(std::span{rows_}.first(count),
                             [&](const Row& row) { return free_residual(row, common_); }));
  common_capture_tau_s_ = events_of(usual_capture(typical_delta_mu), shared).capture_tau_s;
}

LiveJunction::Captured LiveJunction::usual_capture(double delta_mu) const noexcept {
  Captured p;
  p << common_, common_[0] + delta_mu;
  return p;
}

double LiveJunction::carried_on_cost() const noexcept {
  double cost = common_cost_;
  for (std::size_t i = common_count_; i < size_; ++i)
    cost += huber_cost(free_residual(rows_[i], common_), kChoiceLimit);
  return cost;
}

LiveJunction::Events LiveJunction::events_of(const Captured& p,
                                             const SharedParameters& shared) const noexcept {
  const SlipWaveform first{p[0], p[1], p[2], shared.oscillator()};
  Events events;
  const auto captured_s = capture_time_s(first, shared.r);
  events.is_captured = captured_s.has_value();
  events.capture_tau_s = captured_s.value_or(first.rise_end_time_s());
  const DampedBasis basis = damped_basis(shared.oscillator(), std::max(events.capture_tau_s, 0.0));
  events.by_free = {1.0, basis.cosine + 0.5 * shared.gamma * basis.sine, basis.sine};
  const double omega0_squared = shared.omega * shared.omega + 0.25 * shared.gamma * shared.gamma;
  events.rate_by_free = {0.0, -omega0_squared * basis.sine, basis.cosine - 0.5 * shared.gamma * basis.sine};
  events.at_capture = events.by_free.dot(p.head<3>());
  events.onset_tau_s =
      events.capture_tau_s + (std::max(p[3], events.at_capture) - events.at_capture) / shared.r;
  return events;
}

LiveJunction::Point LiveJunction::captured_at(const Row& row, const Captured& p, const Events& events,
                                              const SharedParameters& shared) noexcept {
  const auto& [omega, gamma, r] = shared;
  Point point;
  if (row.tau_s <= events.capture_tau_s) {
    point.by << 1.0, row.by_D, row.by_rate, 0.0;
    point.value = point.by.dot(p);
    return point;
  }
  // c and c′ are continuous at the capture: its shift drops out.
  point.by << events.by_free, 0.0;
  if (row.tau_s <= events.onset_tau_s) {
    point.value = events.at_capture + r * (row.tau_s - events.capture_tau_s);
    return point;
  }
  const double D = std::max(p[3], events.at_capture) - p[0];
  const double B = (r + 0.5 * gamma * D) / omega;
  const double tau_s = row.tau_s - events.onset_tau_s;
  const double decay = std::exp(-0.5 * gamma * tau_s);
  const double cosine = decay * std::cos(omega * tau_s);
  const double sine = decay * std::sin(omega * tau_s);
  const double swing = D * cosine + B * sine;
  const double rate = r * cosine - (0.5 * gamma * B + omega * D) * sine;
  const double by_D = cosine + 0.5 * gamma / omega * sine;
  point.value =
      p[0] + swing - row.half_spread_s2 * (gamma * rate + (omega * omega + 0.25 * gamma * gamma) * swing);
  // The onset comes later by 1/r for each S, and earlier by what the capture is higher.
  point.by *= rate / r;
  point.by[0] += 1.0 - by_D;
  point.by[3] = by_D - rate / r;
  return point;
}

LiveJunction::Assembled LiveJunction::unusual(const Captured& p, const Events& events,
                                              const SharedParameters& shared,
                                              double typical_delta_mu) noexcept {
  Assembled sum{Eigen::Matrix4d::Zero(), Eigen::Vector4d::Zero(), 0.0};
  const auto add = [&](double residual, const Eigen::Vector4d& by) {
    sum.cost += 0.5 * residual * residual;
    sum.normal += by * by.transpose();
    sum.gradient -= residual * by;
  };
  const double D = std::max(p[3], events.at_capture) - p[0];
  const double ratio = D / typical_delta_mu;
  Eigen::Vector4d by = Eigen::Vector4d::Zero();
  if (ratio > kLeastRatio) by = Eigen::Vector4d{-1.0, 0.0, 0.0, 1.0} / (D * kDeltaMuLogScatter);
  add(std::log(std::max(ratio, kLeastRatio)) / kDeltaMuLogScatter, by);
  // At a capture c′ is the stick rate but for rounding, which is not a shortfall.
  if (events.is_captured) return sum;
  // At the end of its rise c′ is stationary, so that the shift of that moment drops out.
  const double shortfall = (shared.r - events.rate_by_free.dot(p.head<3>())) / (kStickRateSpread * shared.r);
  if (shortfall > 0.0) {
    by.setZero();
    by.head<3>() = -events.rate_by_free / (kStickRateSpread * shared.r);
    add(shortfall, by);
  }
  return sum;
}

LiveJunction::Assembled LiveJunction::assemble(const Captured& p, const SharedParameters& shared,
                                               double typical_delta_mu) const noexcept {
  const Events events = events_of(p, shared);
  Assembled sum = unusual(p, events, shared, typical_delta_mu);
  for (const Row& row : rows()) {
    const Point point = captured_at(row, p, events, shared);
    const double z = (row.value - point.value) * row.scale;
    sum.cost += huber_cost(z, kChoiceLimit);
    const double weight = huber_weight(z, kChoiceLimit);
    sum.normal += (weight * row.scale * row.scale * point.by) * point.by.transpose();
    sum.gradient += weight * z * row.scale * point.by;
  }
  return sum;
}

double LiveJunction::log_likelihood_ratio(const Free& free, const Captured& captured,
                                          const SharedParameters& shared, double typical_delta_mu,
                                          double residual_sigmas) const noexcept {
  const Events events = events_of(captured, shared);
  const double per_sigma = 1.0 / std::max(residual_sigmas, 1.0);
  double ratio = -unusual(captured, events, shared, typical_delta_mu).cost * per_sigma * per_sigma;
  for (const Row& row : rows()) {
    const double z = (row.value - captured_at(row, captured, events, shared).value) * row.scale;
    ratio += mixture_cost(free_residual(row, free) * per_sigma) - mixture_cost(z * per_sigma);
  }
  return ratio;
}

double LiveJunction::fit_captured(Captured& p, Assembled now, const SharedParameters& shared,
                                  double typical_delta_mu) const noexcept {
  double damping = kFirstDamping;
  for (int iteration = 0; iteration < kMostLiveIterations; ++iteration) {
    Eigen::Matrix4d normal = now.normal;
    normal.diagonal() *= 1.0 + damping;
    const Eigen::Vector4d scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::Matrix4d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::Vector4d step = scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(now.gradient)));
    const Captured trial = p + step;
    if (!step.allFinite() || !(trial[3] - trial[0] > -sigma_)) {
      damping *= 10.0;
      continue;
    }
    const Assembled next = assemble(trial, shared, typical_delta_mu);
    const double fallen = now.cost - next.cost;
    if (fallen >= 0.0) {
      p = trial;
      now = next;
      damping *= 0.1;
    } else {
      damping *= 10.0;
    }
    if (std::abs(fallen) < kLiveConverged) break;
  }
  return now.cost;
}

void LiveJunction::fit_captured_course(Courses& courses, const Assembled& usual,
                                       const SharedParameters& shared,
                                       double typical_delta_mu) const noexcept {
  courses.captured_cost = std::numeric_limits<double>::infinity();
  // Two starts, as the cost has two valleys: S − K as usual, and hardly any.
  for (const double part : {1.0, 0.1}) {
    Captured p = usual_capture(part * typical_delta_mu);
    const Assembled start = part == 1.0 ? usual : assemble(p, shared, typical_delta_mu);
    const double cost = fit_captured(p, start, shared, typical_delta_mu);
    if (cost < courses.captured_cost) {
      courses.captured_cost = cost;
      courses.captured = p;
    }
    // The second slip has not begun, and nothing says that it should have.
    if (cost <= courses.free_cost && events_of(p, shared).onset_tau_s > rows_[size_ - 1].tau_s) break;
  }
}

JunctionEvidence LiveJunction::ask(std::span<const CyclePoint> points, const SharedParameters& shared,
                                   double sigma, double typical_delta_mu, double decisive) noexcept {
  JunctionEvidence evidence;
  if (points.empty() || points.size() > rows_.size()) return evidence;
  lay_out(points, shared, sigma);
  if (size_ < kFewestRows) return evidence;
  evidence.known = true;
  fit_common(shared, typical_delta_mu);
  const auto count = static_cast<double>(size_);
  const auto is_misfit = [&](double cost) { return 2.0 * cost > kMisfitSigmas * kMisfitSigmas * count; };

  // Neither course can cost less than the common part alone, nor more than when it carries on from there as
  // it usually does. Where these two bounds leave no room for a decisive answer, it is not worked out.
  // (Before the usual capture the second leaves out what a shortfall of c′ would add: the answer may come
  // later.)
  const double room = decisive - kBoundsSlack;
  const double carried_on = carried_on_cost();
  const bool all_free = rows_[size_ - 1].tau_s <= common_capture_tau_s_;
  if (all_free && carried_on - common_cost_ < room && !is_misfit(carried_on)) return evidence;
  const Assembled usual = assemble(usual_capture(typical_delta_mu), shared, typical_delta_mu);
  if (std::max(carried_on, usual.cost) - common_cost_ < room && !is_misfit(carried_on)) return evidence;
  Courses courses;
  courses.free = common_;
  courses.free_cost = fit_free(size_, courses.free);
  if (courses.free_cost - common_cost_ < room && usual.cost - courses.free_cost < room &&
      !is_misfit(courses.free_cost))
    return evidence;
  fit_captured_course(courses, usual, shared, typical_delta_mu);
  while (leave_out_a_stray_of_both(courses, shared)) {
    courses.free_cost = fit_free(size_, courses.free);
    fit_captured_course(courses, assemble(usual_capture(typical_delta_mu), shared, typical_delta_mu), shared,
                        typical_delta_mu);
  }
  const Captured& best = courses.captured;
  const Events events = events_of(best, shared);
  evidence.capture_s = points.front().time_s + events.capture_tau_s;
  evidence.next_onset_s = points.front().time_s + events.onset_tau_s;
  // Where both leave more than noise, the scans tell less than they seem to.
  evidence.residual_sigmas = std::sqrt(2.0 * std::min(courses.free_cost, courses.captured_cost) / count);
  evidence.log_likelihood_ratio =
      log_likelihood_ratio(courses.free, best, shared, typical_delta_mu, evidence.residual_sigmas);
  return evidence;
}

}  // namespace stickslip::friction

#include "core/model/pull_speed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace stickslip::model {
namespace {

bool read_number(std::string_view text, double& number) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && stop == end;
}

}  // namespace

std::optional<PullSpeed> PullSpeed::make(std::vector<SpeedPoint> points) {
  if (points.empty() || points.size() > kMostPoints || points.front().at_s != 0.0) return std::nullopt;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].at_s) || !std::isfinite(points[i].speed_m_per_s)) return std::nullopt;
    if (i > 0 && points[i].at_s < points[i - 1].at_s) return std::nullopt;
  }
  PullSpeed speed{std::move(points)};
  if (speed.pulls_.empty()) return std::nullopt;
  return speed;
}

PullSpeed::PullSpeed(std::vector<SpeedPoint> points) : points_(std::move(points)) {
  double travel_m = 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const SpeedPoint& point = points_[i];
    const bool last = i + 1 == points_.size();
    const double length_s = last ? kForEver : points_[i + 1].at_s - point.at_s;
    if (!(length_s > 0.0)) continue;
    const double end_speed_m_per_s = last ? point.speed_m_per_s : points_[i + 1].speed_m_per_s;
    largest_m_per_s_ = std::max({largest_m_per_s_, point.speed_m_per_s, end_speed_m_per_s});
    const double change = end_speed_m_per_s - point.speed_m_per_s;
    pieces_.push_back({point.at_s, point.speed_m_per_s, change / length_s, travel_m, end_speed_m_per_s});
    if (!last) travel_m += length_s * (point.speed_m_per_s + 0.5 * change);
  }
  find_pulls();
}

void PullSpeed::find_pulls() {
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    const double end_s = i + 1 < pieces_.size() ? pieces_[i + 1].start_s : kForEver;
    const double v = piece.speed_m_per_s;
    const double end_v = piece.end_speed_m_per_s;
    if (v <= 0.0 && end_v <= 0.0) continue;
    Pull pull{piece.start_s, end_s};
    // A zero at an end of the piece is there to the last bit, and is not computed.
    const double zero_s = piece.start_s - v / piece.acceleration_m_per_s2;
    if (v < 0.0) pull.start_s = zero_s;
    if (end_v < 0.0) pull.end_s = std::min(end_s, zero_s);
    if (!(pull.start_s < pull.end_s)) continue;
    if (!pulls_.empty() && pulls_.back().end_s == pull.start_s) {
      pulls_.back().end_s = pull.end_s;
    } else {
      pulls_.push_back(pull);
    }
  }
}

std::optional<PullSpeed> PullSpeed::parse(std::string_view text) {
  std::vector<SpeedPoint> points;
  if (text.ends_with(' ')) return std::nullopt;
  while (!text.empty() && points.size() <= kMostPoints) {
    const std::size_t space = text.find(' ');
    const std::string_view point = text.substr(0, space);
    text = space == std::string_view::npos ? std::string_view{} : text.substr(space + 1);
    const std::size_t colon = point.find(':');
    SpeedPoint read;
    if (colon == std::string_view::npos || !read_number(point.substr(0, colon), read.at_s) ||
        !read_number(point.substr(colon + 1), read.speed_m_per_s)) {
      return std::nullopt;
    }
    points.push_back(read);
  }
  return make(std::move(points));
}

std::string PullSpeed::text() const {
  std::string text;
  for (const SpeedPoint& point : points_) {
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", point.at_s, point.speed_m_per_s);
  }
  return text;
}

const PullSpeed::Piece& PullSpeed::at(double t_s) const noexcept {
  const auto after =
      std::upper_bound(pieces_.begin() + 1, pieces_.end(), t_s,
                       [](double time_s, const Piece& piece) { return time_s < piece.start_s; });
  return *(after - 1);
}

double PullSpeed::speed_m_per_s(double t_s) const noexcept {
  if (t_s < 0.0) return 0.0;
  const Piece& piece = at(t_s);
  return piece.speed_m_per_s + piece.acceleration_m_per_s2 * (t_s - piece.start_s);
}

double PullSpeed::acceleration_m_per_s2(double t_s) const noexcept {
  return t_s < 0.0 ? 0.0 : at(t_s).acceleration_m_per_s2;
}

double PullSpeed::travel_m(double t_s) const noexcept {
  if (t_s < 0.0) return 0.0;
  const Piece& piece = at(t_s);
  const double since_s = t_s - piece.start_s;
  return piece.travel_m + since_s * (piece.speed_m_per_s + 0.5 * piece.acceleration_m_per_s2 * since_s);
}

double PullSpeed::steady_until_s(double t_s) const noexcept {
  if (t_s < 0.0) return 0.0;
  const Piece* const next = &at(t_s) + 1;
  return next == pieces_.data() + pieces_.size() ? kForEver : next->start_s;
}

bool PullSpeed::is_constant() const noexcept {
  return std::all_of(points_.begin(), points_.end(), [&](const SpeedPoint& point) {
    return point.speed_m_per_s == points_.front().speed_m_per_s;
  });
}

}  // namespace stickslip::model

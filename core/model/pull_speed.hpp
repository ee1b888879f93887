/// \file
/// Pull speed as a known function of time, linear between points: the plan of a ramp test, or the reading of
/// a speed channel.
///
///     const auto ramp = PullSpeed::make({{0.0, 0.0023}, {4.5, 0.0113}});   // a ramp of 2 mm/s²
///     const double v = ramp->speed_m_per_s(1.5);
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::model {

/// End time of an interval that does not end, s.
inline constexpr double kForEver = std::numeric_limits<double>::infinity();

/// Speed at a time after the start of the belt.
struct SpeedPoint {
  double at_s = 0.0;
  double speed_m_per_s = 0.0;  ///< Negative: the carriage returns.

  bool operator==(const SpeedPoint&) const = default;
};

class PullSpeed {
 public:
  /// Maximal interval of time after the start in which the belt pulls, v > 0: it begins and ends where the
  /// belt rests or returns. A speed of 0 at one instant does not end it.
  struct Pull {
    double start_s = 0.0;
    double end_s = 0.0;  ///< Infinity if it never stops.
  };

  /// Most points that a plan or a measured course may have.
  static constexpr std::size_t kMostPoints = 100'000;

  /// \param points  the first at 0 s, times not falling; two points at one time are a jump. The belt is at
  ///        rest before the first point and keeps the speed of the last.
  /// \return nullopt if the points are not so, if there are more than kMostPoints, if a value is not finite,
  ///         or if v > 0 at no time.
  [[nodiscard]] static std::optional<PullSpeed> make(std::vector<SpeedPoint> points);
  /// Reads the form that text() writes. \return nullopt if `text` is malformed, or make() refuses its points.
  [[nodiscard]] static std::optional<PullSpeed> parse(std::string_view text);
  /// "0:0.0023 4.5:0.0113", s and m/s; parse() restores each number to the last bit.
  [[nodiscard]] std::string text() const;

  // Values at t_s seconds after the start; at a jump, those after it.
  [[nodiscard]] double speed_m_per_s(double t_s) const noexcept;
  [[nodiscard]] double acceleration_m_per_s2(double t_s) const noexcept;
  /// ∫v from the start, m; 0 before it.
  [[nodiscard]] double travel_m(double t_s) const noexcept;
  /// End of the linear piece that contains t_s; 0 before the start, infinity after the last point.
  [[nodiscard]] double steady_until_s(double t_s) const noexcept;

  /// > 0. Points at which no time is spent do not count.
  [[nodiscard]] double largest_m_per_s() const noexcept { return largest_m_per_s_; }
  /// One speed from the start on.
  [[nodiscard]] bool is_constant() const noexcept;
  [[nodiscard]] const std::vector<SpeedPoint>& points() const noexcept { return points_; }
  /// In the order of time, at least one.
  [[nodiscard]] const std::vector<Pull>& pulls() const noexcept { return pulls_; }

  bool operator==(const PullSpeed& other) const { return points_ == other.points_; }

 private:
  /// v(t) = speed + acceleration (t − start_s) from here to the next piece.
  struct Piece {
    double start_s;
    double speed_m_per_s;
    double acceleration_m_per_s2;
    double travel_m;           ///< At its start.
    double end_speed_m_per_s;  ///< At its end.
  };

  explicit PullSpeed(std::vector<SpeedPoint> points);
  void find_pulls();
  /// The piece at t ≥ 0.
  [[nodiscard]] const Piece& at(double t_s) const noexcept;

  std::vector<SpeedPoint> points_;
  std::vector<Piece> pieces_;
  std::vector<Pull> pulls_;
  double largest_m_per_s_ = 0.0;
};

}  // namespace stickslip::model

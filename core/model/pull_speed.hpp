/// \file
/// How fast a test is meant to pull, where the speed changes in a known way: lines between points, which is
/// what a test plan says and what a speed channel would read.
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

/// The end of what does not end, in seconds.
inline constexpr double kForEver = std::numeric_limits<double>::infinity();

/// At t seconds after the belt has started.
struct SpeedPoint {
  double at_s = 0.0;
  double speed_m_per_s = 0.0;  ///< Negative: the carriage returns.

  bool operator==(const SpeedPoint&) const = default;
};

class PullSpeed {
 public:
  /// A stretch of time in which the belt pulls, v > 0.
  struct Pull {
    double start_s = 0.0;
    double end_s = 0.0;  ///< Infinity if it never stops.
  };

  /// Most points that a plan may have.
  static constexpr std::size_t kMostPoints = 100'000;

  /// \param points  the first at 0 s, none before the one before; two at one time are a jump. At rest before
  ///                the first, on at its speed after the last.
  /// \return nothing unless all are finite, there are at most kMostPoints and the belt pulls at some time.
  [[nodiscard]] static std::optional<PullSpeed> make(std::vector<SpeedPoint> points);
  /// From text(). \return nothing if it is none.
  [[nodiscard]] static std::optional<PullSpeed> parse(std::string_view text);
  /// "0:0.0023 4.5:0.0113", s and m/s; each number is read back to the last bit.
  [[nodiscard]] std::string text() const;

  // At t seconds after the start. At a jump, what comes after it.
  [[nodiscard]] double speed_m_per_s(double t_s) const noexcept;
  [[nodiscard]] double acceleration_m_per_s2(double t_s) const noexcept;
  /// ∫v from the start, m; 0 before it.
  [[nodiscard]] double travel_m(double t_s) const noexcept;
  /// Until when the acceleration stays what it is at t; infinity after the last point.
  [[nodiscard]] double steady_until_s(double t_s) const noexcept;

  /// > 0
  [[nodiscard]] double largest_m_per_s() const noexcept { return largest_m_per_s_; }
  /// One speed from the start to the end.
  [[nodiscard]] bool is_constant() const noexcept;
  [[nodiscard]] const std::vector<SpeedPoint>& points() const noexcept { return points_; }
  /// Rising, at least one.
  [[nodiscard]] const std::vector<Pull>& pulls() const noexcept { return pulls_; }

  bool operator==(const PullSpeed& other) const { return points_ == other.points_; }

 private:
  /// v(t) = speed + acceleration (t − start_s) from here to the next piece.
  struct Piece {
    double start_s;
    double speed_m_per_s;
    double acceleration_m_per_s2;
    double travel_m;  ///< At its start.
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

/// \file
/// Where a course of values was last above, or first below, any level that is asked for afterwards, in a
/// memory that does not grow with the course.
///
///     LastAbove above;
///     for (…) above.add(position, value);
///     const auto position = above.find(level);
///
/// Only values that nothing behind (LastAbove) or before (FirstBelow) them outdoes can ever be the answer:
/// stairs, of which stationary noise has about ln n after n values, and a clean fall one for each value.
/// While kMostSteps suffice the answers are exact. Beyond that neighbours are merged: an answer is then off
/// by less than 2/(kMostSteps − 2) of the course, 0.1 %.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace stickslip::signal {

/// Most steps of the stairs that are kept; 32 kB.
inline constexpr std::size_t kMostSteps = 2048;

/// A value of the course.
struct CourseStep {
  std::size_t position = 0;
  double value = 0.0;
};

/// Steps with rising positions and falling values, no more than kMostSteps. When they are too many, positions
/// are divided into cells, twice as wide each time, and of each cell one step is kept: m steps in different
/// cells of w positions are more than (m − 2) w positions long, so that w < 2 · length/(kMostSteps − 2).
/// Allocates when it is made and never again.
class Stairs {
 public:
  /// Which step of a cell is kept.
  enum class Keep { kFirst, kLast };

  explicit Stairs(Keep keep) : keep_(keep) { steps_.reserve(kMostSteps); }
  ~Stairs() = default;
  // A copy would have less room.
  Stairs(const Stairs&) = delete;
  Stairs& operator=(const Stairs&) = delete;
  Stairs(Stairs&&) noexcept = default;
  Stairs& operator=(Stairs&&) noexcept = default;

  void clear() noexcept;
  /// \param step  behind and below the last one.
  void push(const CourseStep& step) noexcept {
    if (cell_bits_ == 0 && steps_.size() < kMostSteps) {
      steps_.push_back(step);
    } else {
      push_into_cells(step);
    }
  }
  void pop() noexcept { steps_.pop_back(); }

  [[nodiscard]] const std::vector<CourseStep>& steps() const noexcept { return steps_; }

 private:
  [[nodiscard]] bool same_cell(const CourseStep& a, const CourseStep& b) const noexcept {
    return a.position >> cell_bits_ == b.position >> cell_bits_;
  }
  void push_into_cells(const CourseStep& step) noexcept;
  /// Joins the step to the last one if they share a cell.
  [[nodiscard]] bool join(const CourseStep& step) noexcept;
  void widen_cells() noexcept;

  Keep keep_;
  unsigned cell_bits_ = 0;  ///< A cell is 2^this positions wide.
  std::vector<CourseStep> steps_;
};

/// The last position with a value above a level.
class LastAbove {
 public:
  void clear() noexcept { stairs_.clear(); }
  /// \param position  rises from call to call. Amortised O(1).
  void add(std::size_t position, double value) noexcept;
  /// Puts a later part of the course behind this one and empties it. Amortised O(1) for each value.
  void take(LastAbove& later) noexcept;
  /// Nothing if no value is above the level. At most as late as the exact answer.
  [[nodiscard]] std::optional<std::size_t> find(double level) const noexcept;

 private:
  Stairs stairs_{Stairs::Keep::kFirst};
};

/// The first position with a value below a level.
class FirstBelow {
 public:
  void clear() noexcept { stairs_.clear(); }
  /// \param position  rises from call to call. Amortised O(1).
  void add(std::size_t position, double value) noexcept;
  /// Nothing if no value is below the level. At least as late as the exact answer.
  [[nodiscard]] std::optional<std::size_t> find(double level) const noexcept;

 private:
  Stairs stairs_{Stairs::Keep::kLast};
};

}  // namespace stickslip::signal

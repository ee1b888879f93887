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
#include <memory>
#include <optional>
#include <span>

namespace stickslip::signal {

/// Most steps of the stairs that are kept; 32 kB.
inline constexpr std::size_t kMostSteps = 2048;

/// A value of the course. Without initial values: stairs have room for many and write those they use.
struct CourseStep {
  std::size_t position;
  double value;
};

/// Steps with rising positions and falling values, no more than kMostSteps. When they are too many, positions
/// are divided into cells, twice as wide each time, and of each cell one step is kept: m steps in different
/// cells of w positions are more than (m − 2) w positions long, so that w < 2 · length/(kMostSteps − 2).
/// Allocates when it is made and never again. Move-only; one that was moved from can only be assigned to.
class Stairs {
 public:
  /// Which step of a cell is kept.
  enum class Keep { kFirst, kLast };

  explicit Stairs(Keep keep)
      : keep_(keep), steps_(std::make_unique_for_overwrite<CourseStep[]>(kMostSteps)) {}

  void clear() noexcept {
    size_ = 0;
    cell_bits_ = 0;
  }
  /// Behind and below the last one.
  void push(std::size_t position, double value) noexcept {
    if (cell_bits_ == 0 && size_ < kMostSteps) {
      CourseStep& step = steps_[size_++];
      step.position = position;
      step.value = value;
    } else {
      push_into_cells({position, value});
    }
  }
  void pop() noexcept { --size_; }

  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  /// Not empty. \return value of the last step.
  [[nodiscard]] double lowest() const noexcept { return steps_[size_ - 1].value; }
  [[nodiscard]] std::span<const CourseStep> steps() const noexcept { return {steps_.get(), size_}; }

 private:
  [[nodiscard]] bool same_cell(const CourseStep& a, const CourseStep& b) const noexcept {
    return a.position >> cell_bits_ == b.position >> cell_bits_;
  }
  void push_into_cells(const CourseStep& step) noexcept;
  /// Joins the step to the last one if they share a cell.
  [[nodiscard]] bool join(const CourseStep& step) noexcept;
  void widen_cells() noexcept;

  Keep keep_;
  unsigned cell_bits_ = 0;               ///< A cell is 2^this positions wide.
  std::unique_ptr<CourseStep[]> steps_;  ///< Room for kMostSteps, the first `size_` in use.
  std::size_t size_ = 0;
};

/// The last position with a value above a level.
class LastAbove {
 public:
  [[nodiscard]] bool empty() const noexcept { return stairs_.empty(); }
  void clear() noexcept { stairs_.clear(); }
  /// \param position  rises from call to call. Amortised O(1).
  void add(std::size_t position, double value) noexcept {
    while (!stairs_.empty() && stairs_.lowest() <= value) stairs_.pop();
    stairs_.push(position, value);
  }
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
  void add(std::size_t position, double value) noexcept {
    if (!stairs_.empty() && !(value < stairs_.lowest())) return;
    stairs_.push(position, value);
  }
  /// Nothing if no value is below the level. At least as late as the exact answer.
  [[nodiscard]] std::optional<std::size_t> find(double level) const noexcept;

 private:
  Stairs stairs_{Stairs::Keep::kLast};
};

}  // namespace stickslip::signal

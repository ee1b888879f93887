/// \file
/// Position at which a sequence of values was last above, or first below, a level that is given afterwards;
/// in bounded memory.
///
///     LastAbove above;
///     for (…) above.add(position, value);
///     const auto position = above.find(level);
///
/// Only a value that no later one reaches (LastAbove), or no earlier one undercuts (FirstBelow), can be an
/// answer. These values form a staircase. Stationary noise has about ln n steps after n values, a monotone
/// fall one for each value. Up to kMostSteps steps the answers are exact. Beyond that neighbours are merged,
/// and the error of an answer is below 2/(kMostSteps − 2) of the length, 0.1 %.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace stickslip::signal {

/// Largest number of stored steps; 32 kB.
inline constexpr std::size_t kMostSteps = 2048;

/// A value with its position. Members have no initial values, since an array of steps is only partly used.
struct LevelStep {
  std::size_t position;
  double value;
};

/// Steps with rising positions and falling values, no more than kMostSteps. When they are too many, the
/// positions are divided into cells, whose width doubles each time, and one step of each cell is stored. m
/// steps in different cells of width w span more than (m − 2) w positions, so that w < 2 · length/(kMostSteps
/// − 2). Allocates only in the constructor. Move-only; a moved-from object can only be assigned to.
class Stairs {
 public:
  /// Which step of a cell is stored.
  enum class Keep { kFirst, kLast };

  explicit Stairs(Keep keep) : keep_(keep), steps_(std::make_unique_for_overwrite<LevelStep[]>(kMostSteps)) {}

  void clear() noexcept {
    size_ = 0;
    cell_bits_ = 0;
  }
  /// Appends a step, which must lie after and below the last one.
  void push(std::size_t position, double value) noexcept {
    if (cell_bits_ == 0 && size_ < kMostSteps) {
      LevelStep& step = steps_[size_++];
      step.position = position;
      step.value = value;
    } else {
      push_into_cells({position, value});
    }
  }
  /// Removes the last step. Requires !empty().
  void pop() noexcept { --size_; }

  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  /// Requires !empty(). \return value of the last step.
  [[nodiscard]] double lowest() const noexcept { return steps_[size_ - 1].value; }
  [[nodiscard]] std::span<const LevelStep> steps() const noexcept { return {steps_.get(), size_}; }

 private:
  [[nodiscard]] bool same_cell(const LevelStep& a, const LevelStep& b) const noexcept {
    return a.position >> cell_bits_ == b.position >> cell_bits_;
  }
  void push_into_cells(const LevelStep& step) noexcept;
  /// Joins the step to the last one if they share a cell.
  [[nodiscard]] bool join(const LevelStep& step) noexcept;
  void widen_cells() noexcept;

  Keep keep_;
  unsigned cell_bits_ = 0;              ///< A cell is 2^this positions wide.
  std::unique_ptr<LevelStep[]> steps_;  ///< Room for kMostSteps, the first `size_` in use.
  std::size_t size_ = 0;
};

/// Finds the last position with a value above a level.
class LastAbove {
 public:
  [[nodiscard]] bool empty() const noexcept { return stairs_.empty(); }
  void clear() noexcept { stairs_.clear(); }
  /// \param position  rises from call to call. Amortised O(1).
  void add(std::size_t position, double value) noexcept {
    while (!stairs_.empty() && stairs_.lowest() <= value) stairs_.pop();
    stairs_.push(position, value);
  }
  /// Appends a later part of the sequence and empties it. Amortised O(1) for each value.
  void take(LastAbove& later) noexcept;
  /// Last position above the level, or an earlier one after merging; nullopt if no value is above.
  [[nodiscard]] std::optional<std::size_t> find(double level) const noexcept;

 private:
  Stairs stairs_{Stairs::Keep::kFirst};
};

/// Finds the first position with a value below a level.
class FirstBelow {
 public:
  void clear() noexcept { stairs_.clear(); }
  /// \param position  rises from call to call. Amortised O(1).
  void add(std::size_t position, double value) noexcept {
    if (!stairs_.empty() && !(value < stairs_.lowest())) return;
    stairs_.push(position, value);
  }
  /// First position below the level, or a later one after merging; nullopt if no value is below.
  [[nodiscard]] std::optional<std::size_t> find(double level) const noexcept;

 private:
  Stairs stairs_{Stairs::Keep::kLast};
};

}  // namespace stickslip::signal

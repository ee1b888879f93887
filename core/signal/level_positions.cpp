#include "core/signal/level_positions.hpp"

#include <algorithm>

namespace stickslip::signal {

void Stairs::push_into_cells(const LevelStep& step) noexcept {
  if (join(step)) return;
  while (size_ == kMostSteps) {
    widen_cells();
    if (join(step)) return;
  }
  steps_[size_++] = step;
}

bool Stairs::join(const LevelStep& step) noexcept {
  if (cell_bits_ == 0 || size_ == 0 || !same_cell(steps_[size_ - 1], step)) return false;
  if (keep_ == Keep::kLast) steps_[size_ - 1] = step;
  return true;
}

void Stairs::widen_cells() noexcept {
  ++cell_bits_;
  std::size_t kept = 0;
  for (const LevelStep& step : steps()) {
    if (kept == 0 || !same_cell(steps_[kept - 1], step)) {
      steps_[kept++] = step;
    } else if (keep_ == Keep::kLast) {
      steps_[kept - 1] = step;
    }
  }
  size_ = kept;
}

// Of two steps in a cell the first one stays: whoever asks for a level between them, or below both, gets a
// position of the same cell. The last one's position could not answer for a level just below the first's
// value: the step before may be anywhere.

void LastAbove::take(LastAbove& later) noexcept {
  for (const LevelStep& step : later.stairs_.steps()) add(step.position, step.value);
  later.clear();
}

std::optional<std::size_t> LastAbove::find(double level) const noexcept {
  const std::span<const LevelStep> steps = stairs_.steps();
  const auto after = std::partition_point(steps.begin(), steps.end(),
                                          [&](const LevelStep& step) { return step.value > level; });
  if (after == steps.begin()) return std::nullopt;
  return (after - 1)->position;
}

// Here the last one stays, for the same reason seen from the other end.

std::optional<std::size_t> FirstBelow::find(double level) const noexcept {
  const std::span<const LevelStep> steps = stairs_.steps();
  const auto first = std::partition_point(steps.begin(), steps.end(),
                                          [&](const LevelStep& step) { return !(step.value < level); });
  if (first == steps.end()) return std::nullopt;
  return first->position;
}

}  // namespace stickslip::signal

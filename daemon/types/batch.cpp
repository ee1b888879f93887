#include "daemon/types/batch.hpp"

#include <algorithm>

namespace stickslip::daemon {

std::vector<BatchStep> steps(const BatchPlan& plan) {
  std::vector<std::optional<double>> speeds{plan.pull_speeds_m_per_s.begin(), plan.pull_speeds_m_per_s.end()};
  if (speeds.empty()) speeds.emplace_back();
  std::vector<BatchStep> all;
  for (const std::optional<double>& speed : speeds) {
    for (std::int64_t replicate = 1; replicate <= plan.replicates; ++replicate) {
      for (std::int64_t slide = 1; slide <= plan.slides; ++slide) all.push_back({speed, replicate, slide});
    }
  }
  return all;
}

void BatchBook::apply(const BatchEvent& event) {
  if (const auto* begun = std::get_if<BatchBegun>(&event.what)) {
    if (known(begun->batch) != nullptr) return;
    if (!batches_.empty() && !batches_.back().ended_at) batches_.back().ended_at = event.at;
    batches_.push_back({begun->batch, begun->plan, event.who, event.at, std::nullopt, {}});
  } else if (const auto* ended = std::get_if<BatchEnded>(&event.what)) {
    Batch* const batch = known(ended->batch);
    if (batch != nullptr && !batch->ended_at) batch->ended_at = event.at;
  } else if (const auto* recorded = std::get_if<TestRecorded>(&event.what)) {
    Batch* const batch = known(recorded->batch);
    if (batch != nullptr && !has(recorded->batch, recorded->test.record)) {
      BatchTest& test = batch->tests.emplace_back(recorded->test);
      // The record tells the speed of the bench; the batch plans none.
      if (batch->plan.pull_speeds_m_per_s.empty()) test.step.pull_speed_m_per_s.reset();
    }
  } else if (const auto* voided = std::get_if<TestVoided>(&event.what)) {
    voided_.try_emplace(voided->record, Voiding{voided->reason, event.who, event.at});
  } else if (const auto* restored = std::get_if<TestRestored>(&event.what)) {
    voided_.erase(restored->record);
  }
}

Batch* BatchBook::known(std::string_view id) noexcept {
  const auto found =
      std::find_if(batches_.begin(), batches_.end(), [id](const Batch& batch) { return batch.id == id; });
  return found == batches_.end() ? nullptr : &*found;
}

const Batch* BatchBook::current() const noexcept {
  return batches_.empty() || batches_.back().ended_at ? nullptr : &batches_.back();
}

const Batch* BatchBook::find(std::string_view id_or_name) const noexcept {
  const auto by = [this](auto matches) {
    const auto found = std::find_if(batches_.rbegin(), batches_.rend(), matches);
    return found == batches_.rend() ? nullptr : &*found;
  };
  if (const Batch* exact = by([&](const Batch& batch) { return batch.id == id_or_name; })) return exact;
  return by([&](const Batch& batch) { return batch.plan.sample.name == id_or_name; });
}

const Voiding* BatchBook::voided(const std::string& record) const noexcept {
  const auto found = voided_.find(record);
  return found == voided_.end() ? nullptr : &found->second;
}

bool BatchBook::has(std::string_view batch, std::string_view record) const noexcept {
  return std::any_of(batches_.begin(), batches_.end(), [&](const Batch& own) {
    return own.id == batch && std::any_of(own.tests.begin(), own.tests.end(),
                                          [&](const BatchTest& test) { return test.record == record; });
  });
}

std::optional<BatchStep> BatchBook::next_step(const Batch& batch,
                                              std::span<const BatchStep> under_way) const {
  for (const BatchStep& step : steps(batch.plan)) {
    const bool made = std::find(under_way.begin(), under_way.end(), step) != under_way.end() ||
                      std::any_of(batch.tests.begin(), batch.tests.end(), [&](const BatchTest& test) {
                        return test.step == step && voided(test.record) == nullptr;
                      });
    if (!made) return step;
  }
  return std::nullopt;
}

}  // namespace stickslip::daemon

#include "core/record/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <boost/uuid/uuid_generators.hpp>
#include <boost/uuid/uuid_io.hpp>

namespace stickslip::record {
namespace {

constexpr std::array<std::pair<Status, std::string_view>, 4> kStatusNames{{
    {Status::kComplete, "complete"},
    {Status::kInterrupted, "interrupted"},
    {Status::kRecovered, "recovered"},
    {Status::kIncomplete, "incomplete"},
}};

}  // namespace

std::string version_refusal(std::int64_t version) {
  if (version >= kOldestFormatVersion && version <= kFormatVersion) return {};
  return fmt::format("is {} version {}; this program reads {} to {}: use {}", kFormat, version,
                     kOldestFormatVersion, kFormatVersion,
                     version > kFormatVersion ? "a newer one" : "one that made it");
}

std::string_view name(Status status) noexcept {
  for (const auto& [value, text] : kStatusNames) {
    if (value == status) return text;
  }
  return "incomplete";
}

std::optional<Status> status_from_name(std::string_view text) noexcept {
  for (const auto& [value, known] : kStatusNames) {
    if (known == text) return value;
  }
  return std::nullopt;
}

TesterFacts TesterFacts::of(const model::Tester& tester) {
  TesterFacts facts;
  facts.sled_mass_kg = tester.sled_mass_kg;
  facts.gravity_m_per_s2 = tester.gravity_m_per_s2;
  facts.pull_speed_m_per_s = tester.pull_speed_m_per_s;
  facts.stiffness_N_per_m = tester.stiffness_N_per_m;
  if (tester.speed_course) facts.speed_course = tester.speed_course->text();
  facts.set_transducer(tester.transducer);
  return facts;
}

void TesterFacts::set_transducer(const model::Transducer& transducer) {
  if (transducer.load_cell) {
    load_cell_frequency_Hz = transducer.load_cell->frequency_Hz;
    load_cell_damping = transducer.load_cell->damping_ratio;
  }
  if (transducer.anti_alias) {
    anti_alias_Hz = transducer.anti_alias->cutoff_Hz;
    anti_alias_order = transducer.anti_alias->order;
  }
}

model::Tester TesterFacts::tester() const {
  model::Tester tester;
  tester.sled_mass_kg = sled_mass_kg.value_or(tester.sled_mass_kg);
  tester.gravity_m_per_s2 = gravity_m_per_s2.value_or(tester.gravity_m_per_s2);
  tester.pull_speed_m_per_s = pull_speed_m_per_s;
  tester.stiffness_N_per_m = stiffness_N_per_m;
  tester.speed_course = model::PullSpeed::parse(speed_course);
  model::Transducer stated;
  if (load_cell_frequency_Hz)
    stated.load_cell = {*load_cell_frequency_Hz, load_cell_damping.value_or(model::kTypicalCellDamping)};
  if (anti_alias_Hz) {
    constexpr std::int64_t kMost = model::AntiAlias::kHighestOrder + 1;  // Out of range, as is 0.
    stated.anti_alias = {*anti_alias_Hz,
                         static_cast<int>(std::clamp<std::int64_t>(
                             anti_alias_order.value_or(model::kTypicalFilterOrder), 0, kMost))};
  }
  if (stated.is_valid()) tester.transducer = stated;
  return tester;
}

std::optional<std::int64_t> realtime_at(const RecordHeader& header, daq::ScanIndex scan) noexcept {
  if (!header.start_realtime_ns || !header.trigger_scan) return std::nullopt;
  const double since_ns =
      1e9 * static_cast<double>(scan - *header.trigger_scan) / header.board.scan_rate_granted_Hz;
  constexpr double kMost_ns = 9e18;
  std::int64_t time_ns = 0;
  if (!(std::abs(since_ns) < kMost_ns) ||
      __builtin_add_overflow(*header.start_realtime_ns, std::llround(since_ns), &time_ns)) {
    return std::nullopt;
  }
  return time_ns;
}

analysis::TestResults absent_results(const std::string& reason) {
  analysis::TestResults results;
  results.regime_reason = reason;
  results.rung_reason = reason;
  analysis::for_each_result(results, [&](const analysis::ResultName&, analysis::Estimate& estimate) {
    estimate = analysis::Estimate::none(reason);
  });
  return results;
}

void set_end(Record& record, EndRecord end) {
  record.cycles = std::exchange(end.cycles, {});
  record.spikes = std::exchange(end.spikes, {});
  record.end = std::move(end);
}

std::string make_uuid() { return boost::uuids::to_string(boost::uuids::random_generator()()); }

}  // namespace stickslip::record

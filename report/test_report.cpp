#include "report/test_report.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "report/budget_forms.hpp"
#include "report/report_page.hpp"
#include "report/trace_json.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/quantities.hpp"
#include "core/analysis/skipped_corrections.hpp"
#include "core/base/digits.hpp"
#include "core/base/wording.hpp"
#include "core/model/method.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/method_text.hpp"
#include "core/record/read_apart.hpp"
#include "daemon/types/batch_journal.hpp"
#include "daemon/types/voidings.hpp"

namespace stickslip::report {

namespace {

/// "20261122T180301Z (liner 42), …", the latest first.
std::string names_of(const daemon::BatchBook& book) {
  std::string text;
  for (auto batch = book.batches().rbegin(); batch != book.batches().rend(); ++batch)
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", batch->id, batch->plan.sample.name);
  return text.empty() ? "none" : base::one_line(text, 400);
}

/// Names of the compared quantities, and of what budgets and changing speeds need.
std::vector<std::string> results_of_tables() {
  std::vector<std::string> names{
      "smallest_slip", "pull_speed_measured",   "drift_rate", "Q", "delta_mu_scatter",
      "escape_speed",  "escape_speed_corrected"};
  for (const analysis::Quantity& quantity : analysis::quantities()) names.emplace_back(quantity.name);
  return names;
}

}  // namespace

base::Result<Material> read_material(std::string label, std::span<const std::string> files, Detail detail,
                                     analysis::Pooling pooling) {
  const std::vector<std::string> only =
      detail == Detail::kTables ? results_of_tables() : std::vector<std::string>{};
  const bool with_traces = detail == Detail::kTraces;
  Material material;
  material.label = std::move(label);
  material.pooling = pooling;
  daemon::Voidings voidings;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string& file = files[i];
    auto voided = voidings.of(file);
    if (!voided) return tl::unexpected(voided.error());
    if (*voided) {
      material.voided.push_back({file, **std::move(voided)});
      continue;
    }
    const std::span<const std::string> next = files.subspan(i + 1);
    base::Result<record::Record> record =
        with_traces ? record::read_record_apart(file, next) : record::read_results_apart(file, only, next);
    if (!record) return tl::unexpected(record.error());
    const record::TesterFacts& tester = record->header.tester;
    ReportedTest test;
    test.file = file;
    test.title = record->header.title;
    test.method = record->header.process.method;
    test.sample = record->header.sample;
    if (record->header.start_realtime_ns)
      test.start_time = record::iso_time(*record->header.start_realtime_ns);
    test.scans_sha256 = record->sha256;
    if (!record->header.process.estimator.empty()) test.estimator = record->header.process.estimator;
    // A method in another form is shown as it stands; nothing can be compared with it.
    std::optional<model::Nominal> asked;
    if (const base::Result<model::Method> method = record::method_from_text(test.method)) {
      test.departures = model::departures(*method, tester.sled_mass_kg, tester.pull_speed_m_per_s);
      asked = method->pull_speed_m_per_s;
    }
    if (const std::optional<double>& speed = tester.pull_speed_m_per_s)
      test.speed = base::unit_of_speed(asked ? asked->value : *speed).text(*speed);
    test.facts = facts_of(record->header, test.speed);
    if (with_traces) {
      const base::Result<nlohmann::ordered_json> trace = trace_json(*record);
      if (!trace) {
        return tl::unexpected(
            base::Error{trace.error().kind, fmt::format("{}: {}", file, trace.error().message)});
      }
      test.trace = json_for_script(*trace);
    }
    test.truth = std::move(record->end->truth);
    const analysis::SkippedCorrections skipped =
        analysis::skipped_from_text(record->header.process.kept).value_or(analysis::SkippedCorrections{});
    analysis::MeasuredTest measured{tester.pull_speed_m_per_s,
                                    std::move(record->end->results),
                                    analysis::slip_sums(record->cycles, skipped.first_slip),
                                    test.sample.grade,
                                    analysis::mean_stick_time_s(record->cycles, skipped.first_slip),
                                    budget_facts_of(record->header)};
    if (detail != Detail::kTables) {
      const std::vector<analysis::RestedSlip> rested = analysis::rested_slips(record->cycles);
      measured.speed_changes = !measured.results.Q.value && analysis::have_several_speeds(rested);
      measured.rests = analysis::group_by_rest(rested, measured.results);
    }
    material.measured.push_back(std::move(measured));
    material.tests.push_back(std::move(test));
  }
  if (material.tests.empty() && !material.voided.empty()) {
    return base::usage_error("{}: is void ({}), and so is all that was named; there is nothing to report",
                             material.voided.front().file, material.voided.front().voiding.reason);
  }
  material.groups = analysis::group_by_speed(material.measured, pooling);
  return material;
}

base::Result<Material> read_batch(std::string label, const std::string& id_or_name,
                                  const std::filesystem::path& folder, Detail detail,
                                  analysis::Pooling pooling) {
  daemon::BatchBook book;
  daemon::BatchJournal journal{folder};
  if (const auto read = journal.read_on(book); !read) return tl::unexpected(read.error());
  const daemon::Batch* const batch = book.find(id_or_name);
  if (batch == nullptr) {
    return base::usage_error("{}: has no batch \"{}\"; it has {}", journal.path().string(),
                             base::one_line(id_or_name), names_of(book));
  }
  std::vector<std::string> files;
  for (const daemon::BatchTest& test : batch->tests) files.push_back((folder / test.record).string());
  if (files.empty()) return base::usage_error("batch {} has no test yet", batch->id);
  if (label.empty()) label = batch->plan.sample.name.empty() ? batch->id : batch->plan.sample.name;
  // A limit may be one of any result.
  if (!batch->plan.limits.empty()) detail = std::max(detail, Detail::kResults);
  base::Result<Material> material = read_material(std::move(label), files, detail, pooling);
  if (!material) return material;
  for (const auto& [quantity, limits] : batch->plan.limits)
    material->limits.push_back(daemon::judged(quantity, limits, material->measured));
  return material;
}

std::string speed_of(const Material& material, const analysis::SpeedGroup& group) {
  const std::string& speed = material.tests[group.tests.front()].speed;
  if (!speed.empty()) return speed;
  return group.pull_speed_m_per_s ? base::speed_text(*group.pull_speed_m_per_s) : "speed not known";
}

std::string group_text(const Material& material, const analysis::SpeedGroup& group) {
  std::vector<std::string> parts;
  for (const std::string& grade : group.grades) {
    if (!grade.empty()) parts.push_back(grade);
  }
  parts = parts.empty() ? parts : std::vector{fmt::format("{}", fmt::join(parts, " and "))};
  parts.push_back(speed_of(material, group));
  std::vector<std::string_view> regimes;
  for (const model::Regime regime : group.regimes) regimes.push_back(model::name(regime));
  parts.push_back(fmt::format("{}", fmt::join(regimes, " and ")));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string not_pooled_text(const Material& material) {
  bool grades = false;
  bool regimes = false;
  for (std::size_t i = 1; i < material.groups.size(); ++i) {
    const analysis::SpeedGroup& one = material.groups[i - 1];
    const analysis::SpeedGroup& other = material.groups[i];
    if (analysis::pair_speeds({&one, 1}, {&other, 1}).size() != 1) continue;
    grades |= one.grades != other.grades;
    regimes |=
        analysis::grouping_regime(one.regimes.front()) != analysis::grouping_regime(other.regimes.front());
  }
  if (!grades && !regimes) return {};
  return fmt::format("{} at one speed are not averaged; --pool {} does",
                     grades && regimes ? "Grades and regimes"
                     : grades          ? "Grades"
                                       : "Regimes",
                     grades && regimes ? "grades,regimes"
                     : grades          ? "grades"
                                       : "regimes");
}

base::Result<void> check_one_grade(const Material& material, std::string_view side) {
  if (material.pooling.grades) return {};
  const std::string& first = material.tests.front().sample.grade;
  for (const ReportedTest& test : material.tests) {
    if (test.sample.grade == first) continue;
    const auto shown = [](const std::string& grade) {
      return grade.empty() ? std::string{"no grade"}
                           : fmt::format("grade \"{}\"", base::one_line(grade, 100));
    };
    return base::usage_error("{}: {} has {}, {} has {}: name the records of one grade, or --pool grades",
                             side, material.tests.front().file, shown(first), test.file,
                             shown(test.sample.grade));
  }
  return {};
}

bool has_speeds(const Material& material) {
  const auto known = [](const analysis::SpeedGroup& group) { return group.pull_speed_m_per_s.has_value(); };
  const auto first = std::find_if(material.groups.begin(), material.groups.end(), known);
  return std::any_of(first, material.groups.end(), [&](const analysis::SpeedGroup& group) {
    return known(group) && analysis::pair_speeds({&*first, 1}, {&group, 1}).size() > 1;
  });
}

base::Result<analysis::Pooling> pooling_from_text(std::string_view text, std::string_view place) {
  analysis::Pooling pooling;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string_view word = text.substr(at, end - at);
    if (word == "grades") {
      pooling.grades = true;
    } else if (word == "regimes") {
      pooling.regimes = true;
    } else {
      return base::usage_error("{} \"{}\": must be grades, regimes or grades,regimes", place,
                               base::one_line(word, 100));
    }
    at = end + 1;
  }
  return pooling;
}

void note_repeated_scans(std::initializer_list<Material*> materials) {
  std::map<std::string, std::string> files;
  for (Material* const material : materials) {
    for (std::size_t i = 0; i < material->tests.size(); ++i) {
      const ReportedTest& test = material->tests[i];
      const auto [earlier, is_new] = files.try_emplace(test.scans_sha256, test.file);
      if (is_new) continue;
      base::add(
          material->measured[i].results.findings,
          base::make_finding(
              base::FindingCode::kRepeatedScans,
              fmt::format("has the same scans as {}: the trace was imported twice, or the record copied",
                          earlier->second)));
    }
  }
}

namespace {

RegimeCounts regime_counts(const Material& material, const std::optional<std::size_t>& group) {
  RegimeCounts counts;
  if (!group) return counts;
  for (const std::size_t test : material.groups[*group].tests) {
    switch (material.measured[test].results.regime) {
      case model::Regime::kStickSlip:
      case model::Regime::kMixed:
        ++counts.sticking;
        break;
      case model::Regime::kRingDown:
      case model::Regime::kInertialOscillation:
      case model::Regime::kSteadySliding:
        ++counts.sliding;
        break;
      case model::Regime::kUndecided:
        break;
    }
  }
  return counts;
}

}  // namespace

MaterialComparison compare_materials(const Material& a, const Material& b) {
  MaterialComparison result;
  result.pairs = analysis::pair_speeds(a.groups, b.groups);
  std::array<std::vector<double>, analysis::kQuantityCount> p;
  for (const analysis::SpeedPair& pair : result.pairs) {
    RegimeComparison regime{regime_counts(a, pair.a), regime_counts(b, pair.b), std::nullopt};
    if (regime.a.sticking + regime.a.sliding > 0 && regime.b.sticking + regime.b.sliding > 0) {
      regime.p = analysis::exact_p(regime.a.sticking, regime.a.sliding, regime.b.sticking, regime.b.sliding);
    }
    result.regimes.push_back(regime);
    result.by_cycle.push_back(analysis::compare_pair_by_cycle(a.groups, b.groups, pair));
    auto& comparisons = result.comparisons.emplace_back();
    for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
      comparisons[q] = analysis::compare_pair(a.groups, b.groups, pair, q);
      if (comparisons[q].welch) p[q].push_back(comparisons[q].welch->p);
    }
  }
  for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
    if (p[q].size() < 2) continue;
    result.combined[q] = {analysis::combined_p(p[q]), static_cast<int>(p[q].size())};
  }
  return result;
}

}  // namespace stickslip::report

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "core/record/finding_json.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"

namespace stickslip::record {
namespace {

constexpr const char* kReason = "reason";
constexpr const char* kRung = "rung";
constexpr const char* kMisfit = "misfit";
constexpr const char* kPlace = "place";
constexpr const char* kCode = "code";
constexpr const char* kSeverity = "severity";
constexpr const char* kAction = "action";
constexpr const char* kNumbers = "numbers";
/// The last result in the oldest records; later results were added by newer versions.
constexpr std::string_view kLastOfTheFirst = "scan_rate_measured";

/// "systematic_uncertainty_zero"
std::string part_attribute(analysis::UncertaintySource source) {
  return fmt::format("{}_{}", kSystematic, name_of(source).name);
}

void write_estimate(hid_t group, const analysis::ResultName& name, const analysis::Estimate& estimate) {
  const std::string long_name = fmt::format("{} [{}]", name.long_name, name.unit);
  const DatasetHandle value = write_scalar(group, FieldName{name.name, name.unit, long_name},
                                           estimate.value.value_or(std::numeric_limits<double>::quiet_NaN()));
  if (estimate.standard_error) write_number_attribute(value.get(), kStandardError, *estimate.standard_error);
  if (estimate.systematic_uncertainty)
    write_number_attribute(value.get(), kSystematic, *estimate.systematic_uncertainty);
  for_each_part(estimate.systematic_parts,
                [&](analysis::UncertaintySource source, const std::optional<double>& size) {
                  if (size) write_number_attribute(value.get(), part_attribute(source), *size);
                });
  if (!estimate.value) write_attribute(value.get(), kReason, estimate.reason);
}

analysis::Estimate read_estimate(hid_t group, const std::string& key) {
  const DatasetHandle dataset = open_dataset(group, key);
  analysis::Estimate estimate;
  if (auto reason = find_attribute(dataset.get(), kReason)) {
    estimate = analysis::Estimate::none(*std::move(reason));
  } else {
    estimate.value = read_scalar<double>(dataset, key);
  }
  estimate.standard_error = find_number_attribute<double>(dataset.get(), kStandardError);
  estimate.systematic_uncertainty = find_number_attribute<double>(dataset.get(), kSystematic);
  for_each_part(estimate.systematic_parts,
                [&](analysis::UncertaintySource source, std::optional<double>& size) {
                  size = find_number_attribute<double>(dataset.get(), part_attribute(source));
                });
  return estimate;
}

/// Records before version 3 have no rung.
void read_rung(hid_t group, analysis::TestResults& results) {
  if (!has(group, kRung)) {
    results.rung_reason = kNoSuchResultThen;
    return;
  }
  const DatasetHandle dataset = open_dataset(group, kRung);
  const std::string rung = read_text(dataset, kRung);
  const auto known = analysis::rung_from_name(rung);
  if (!known) throw HdfError(fmt::format("results/rung '{}' is unknown", rung));
  results.rung = *known;
  results.rung_reason = read_attribute(dataset.get(), kReason);
}

/// A row for each sentence in results/findings.
void write_finding_rows(hid_t entry, const std::vector<base::Finding>& findings) {
  if (findings.empty()) return;
  const GroupHandle group = make_group(entry, kFindings, "NXcollection");
  const auto column = [&](const char* name, auto text_of) {
    std::vector<std::string> texts;
    texts.reserve(findings.size());
    for (const base::Finding& finding : findings) texts.emplace_back(text_of(finding));
    write_texts(group.get(), name, texts);
  };
  column(kCode, [](const base::Finding& finding) { return finding.code; });
  column(kSeverity, [](const base::Finding& finding) { return base::name(finding.severity); });
  column(kAction, [](const base::Finding& finding) { return finding.action; });
  column(kNumbers, [](const base::Finding& finding) {
    return numbers_json<nlohmann::ordered_json>(finding.numbers)
        .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  });
}

/// Records of before have no rows: their sentences are uncoded.
std::vector<base::Finding> read_findings(hid_t entry, const std::vector<std::string>& texts) {
  std::vector<base::Finding> findings;
  findings.reserve(texts.size());
  for (const std::string& text : texts)
    findings.push_back(base::make_finding(base::FindingCode::kUncoded, text));
  if (!has(entry, kFindings)) return findings;
  const GroupHandle group = open_group(entry, kFindings);
  const auto column = [&](const char* name) {
    std::vector<std::string> rows = read_texts(group.get(), name);
    if (rows.size() != findings.size()) {
      throw HdfError(fmt::format("findings/{} has {} rows, results/findings has {}", name, rows.size(),
                                 findings.size()));
    }
    return rows;
  };
  const std::vector<std::string> codes = column(kCode);
  const std::vector<std::string> severities = column(kSeverity);
  const std::vector<std::string> actions = column(kAction);
  const std::vector<std::string> numbers = column(kNumbers);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    findings[i].code = codes[i];
    const auto severity = base::severity_from_name(severities[i]);
    if (!severity) throw HdfError(fmt::format("findings/severity '{}' is unknown", severities[i]));
    findings[i].severity = *severity;
    findings[i].action = actions[i];
    try {
      findings[i].numbers = numbers_from_json(nlohmann::ordered_json::parse(numbers[i]));
    } catch (const nlohmann::json::exception&) {
      throw HdfError(fmt::format("findings/numbers row {} is no list of numbers in JSON", i + 1));
    }
  }
  return findings;
}

}  // namespace

void write_results(hid_t entry, const analysis::TestResults& results) {
  const GroupHandle group = make_group(entry, "results", "NXcollection");
  const DatasetHandle regime = write_text(group.get(), "regime", model::name(results.regime));
  write_attribute(regime.get(), kReason, results.regime_reason);
  const DatasetHandle rung = write_text(group.get(), kRung, analysis::name(results.rung));
  write_attribute(rung.get(), kReason, results.rung_reason);
  const GroupHandle diagnostics = make_group(group.get(), kDiagnostics, "NXcollection");
  analysis::for_each_result(
      results, [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
        write_estimate(name.is_diagnostic ? diagnostics.get() : group.get(), name, estimate);
      });
  if (!results.misfit_place.empty())
    write_attribute(open_dataset(group.get(), kMisfit).get(), kPlace, results.misfit_place);
  write_texts(group.get(), kFindings, base::texts_of(results.findings));
  write_finding_rows(entry, results.findings);
}

analysis::TestResults read_results(hid_t entry, std::span<const std::string> only) {
  if (!has(entry, "results")) return absent_results("the record holds no results");
  const GroupHandle group = open_group(entry, "results");
  analysis::TestResults results;
  const DatasetHandle dataset = open_dataset(group.get(), "regime");
  const std::string regime = read_text(dataset, "regime");
  const auto known = model::regime_from_name(regime);
  if (!known) throw HdfError(fmt::format("results/regime '{}' is unknown", regime));
  results.regime = *known;
  results.regime_reason = read_attribute(dataset.get(), kReason);
  read_rung(group.get(), results);
  // Versions 1 and 2 have the diagnostics among the other results.
  std::optional<GroupHandle> diagnostics;
  if (has(group.get(), kDiagnostics)) diagnostics.emplace(open_group(group.get(), kDiagnostics));
  bool may_be_missing = false;
  analysis::for_each_result(results, [&](const analysis::ResultName& name, analysis::Estimate& estimate) {
    const std::string key{name.name};
    const bool came_later = std::exchange(may_be_missing, may_be_missing || name.name == kLastOfTheFirst);
    if (!only.empty() && std::ranges::find(only, key) == only.end()) {
      estimate = analysis::Estimate::none("not read");
      return;
    }
    const hid_t parent = name.is_diagnostic && diagnostics ? diagnostics->get() : group.get();
    estimate = came_later && !has(parent, key) ? analysis::Estimate::none(std::string{kNoSuchResultThen})
                                               : read_estimate(parent, key);
  });
  if (has(group.get(), kMisfit)) {
    results.misfit_place =
        find_attribute(open_dataset(group.get(), kMisfit).get(), kPlace).value_or(std::string{});
  }
  if (has(group.get(), kFindings))
    results.findings = read_findings(entry, read_texts(group.get(), kFindings));
  return results;
}

}  // namespace stickslip::record

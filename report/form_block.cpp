#include "report/form_block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>

#include "io/table.hpp"
#include "report/test_report.hpp"

#include "core/base/finding.hpp"
#include "core/record/iso_time.hpp"

namespace stickslip::report {
namespace {

struct Fact {
  std::string_view name;
  std::string_view label;
  std::string_view several;  ///< "3 operators".
};

constexpr std::array<Fact, kFactCount> kFacts{{{"date", "date", "dates"},
                                               {"sample", "sample", "samples"},
                                               {"grade", "grade", "grades"},
                                               {"lot", "lot", "lots"},
                                               {"direction", "direction, side", "directions or sides"},
                                               {"conditioning", "conditioning", "conditionings"},
                                               {"climate", "climate", "climates"},
                                               {"method", "method", "methods"},
                                               {"sled", "sled", "sleds"},
                                               {"contact_time", "contact time", "contact times"},
                                               {"speed", "pull speed", "speeds"},
                                               {"operator", "operator", "operators"},
                                               {"instrument", "instrument", "instruments"},
                                               {"calibration", "calibration", "calibrations"},
                                               {"program", "program", "programs"}}};
/// The number of tests stands behind the speed.
constexpr std::size_t kBehindSpeed = 11;
constexpr std::size_t kMostNamed = 4;  ///< Of the values that differ.

/// "Contact time" and "contact-time" are "contact_time".
std::string plain_key(std::string_view key) {
  std::string plain{key};
  for (char& c : plain) {
    if (c == ' ' || c == '-') c = '_';
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return plain;
}

std::string joined(std::initializer_list<std::string> parts) {
  std::string text;
  for (const std::string& part : parts) {
    if (!part.empty()) text += fmt::format("{}{}", text.empty() ? "" : ", ", part);
  }
  return text;
}

std::string calibration_text(const record::RecordHeader& header) {
  if (!header.load_cell) return {};
  const record::CalibrationFacts& own = header.calibration;
  constexpr std::size_t kDay = 10;  // Characters of "2026-11-27".
  return joined({fmt::format("{:.6g} N/V", header.load_cell->gain_N_per_V),
                 own.date.empty() ? "date not stated" : "of " + own.date.substr(0, kDay),
                 own.certificate.empty() ? "" : "certificate " + own.certificate});
}

std::string program_text(const record::ProcessFacts& process) {
  if (process.program.empty()) return {};
  std::string text = process.program;
  if (!process.version.empty()) text += " " + process.version;
  return process.commit.empty() ? text : fmt::format("{} ({})", text, process.commit);
}

std::string text_of(const Fact& fact, const FormLine& line, std::size_t count) {
  if (line.values.empty()) return std::string{io::kAbsent};
  std::string text;
  if (line.values.size() == 1) {
    text = line.values.front();
  } else {
    const std::span named = std::span{line.values}.first(std::min(line.values.size(), kMostNamed));
    text = fmt::format("{} {}: {}{}", line.values.size(), fact.several, fmt::join(named, "; "),
                       named.size() < line.values.size() ? "; …" : "");
  }
  if (line.not_stated > 0) text += fmt::format("; not stated in {} of {}", line.not_stated, count);
  return text;
}

std::string count_of(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace

RecordFacts facts_of(const record::RecordHeader& header, const std::string& speed) {
  const auto stated = [&header](std::string_view key, const std::string& field = {}) {
    if (!field.empty()) return field;
    const auto found = std::find_if(header.sample.metadata.begin(), header.sample.metadata.end(),
                                    [key](const auto& pair) { return plain_key(pair.first) == key; });
    return found == header.sample.metadata.end() ? std::string{} : found->second;
  };
  constexpr std::size_t kDay = 10;
  constexpr double kGrams = 1e3;
  const record::TesterFacts& tester = header.tester;
  return {
      header.start_realtime_ns ? record::iso_time(*header.start_realtime_ns).substr(0, kDay) : "",
      stated("sample", header.sample.name),
      stated("grade", header.sample.grade),
      stated("lot"),
      joined({stated("direction", header.sample.direction), stated("side", header.sample.side)}),
      stated("conditioning"),
      joined({stated("temperature"), stated("humidity")}),
      header.process.method,
      tester.sled_mass_kg ? fmt::format("{:.6g} g", *tester.sled_mass_kg * kGrams) : "",
      stated("contact_time"),
      speed,
      stated("operator", header.sample.operator_name),
      stated("instrument", header.board.board_name.empty() ? header.board.driver : header.board.board_name),
      calibration_text(header),
      program_text(header.process)};
}

std::vector<FormLine> form_of(const Material& material) {
  std::vector<FormLine> lines;
  for (std::size_t f = 0; f < kFactCount; ++f) {
    FormLine line{kFacts[f].name, kFacts[f].label, {}, 0, {}};
    for (const ReportedTest& test : material.tests) {
      const std::string& value = test.facts[f];
      if (value.empty()) {
        ++line.not_stated;
      } else if (std::find(line.values.begin(), line.values.end(), value) == line.values.end()) {
        line.values.push_back(value);
      }
    }
    line.text = text_of(kFacts[f], line, material.tests.size());
    lines.push_back(std::move(line));
  }
  std::string n = fmt::format("{}", material.tests.size());
  if (!material.voided.empty()) n += fmt::format("; {} void, left out", material.voided.size());
  lines.insert(lines.begin() + kBehindSpeed,
               FormLine{"n", "n", {fmt::format("{}", material.tests.size())}, 0, std::move(n)});
  return lines;
}

std::string verdict_of(const Material& material) {
  const auto failed = std::count_if(material.limits.begin(), material.limits.end(),
                                    [](const daemon::LimitVerdict& own) { return !own.passes(); });
  std::string text;
  if (material.limits.empty()) {
    text = "no limits were stated";
  } else if (failed == 0) {
    text = fmt::format("PASS, within {}", count_of(material.limits.size(), "limit"));
  } else {
    text = fmt::format("FAIL, {} of {} not kept", failed, count_of(material.limits.size(), "limit"));
  }
  const auto departing = std::count_if(material.tests.begin(), material.tests.end(),
                                       [](const ReportedTest& test) { return !test.departures.empty(); });
  if (departing > 0) {
    text +=
        fmt::format("; {} of {} not as the method asks", departing, count_of(material.tests.size(), "test"));
  }
  const auto doubtful = std::count_if(
      material.measured.begin(), material.measured.end(), [](const analysis::MeasuredTest& test) {
        return std::any_of(
            test.results.findings.begin(), test.results.findings.end(),
            [](const base::Finding& finding) { return finding.severity != base::Severity::kNote; });
      });
  if (doubtful > 0)
    text += fmt::format("; findings in {}", count_of(static_cast<std::size_t>(doubtful), "test"));
  return text;
}

}  // namespace stickslip::report

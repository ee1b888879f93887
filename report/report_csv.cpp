#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/report_json.hpp"

#include "core/analysis/results.hpp"
#include "core/base/text.hpp"

namespace stickslip::report {
namespace {

/// One line of cells.
class Line {
 public:
  Line& text(std::string_view cell) {
    separate();
    line_ += base::csv_cell(cell);
    return *this;
  }

  /// The shortest digits that read back to the same number; empty if there is none.
  template <typename T>
  Line& number(const std::optional<T>& value) {
    separate();
    if (value) line_ += fmt::format("{}", *value);
    return *this;
  }

  Line& interval(const std::optional<analysis::Interval>& value) {
    number(value ? std::optional{value->low} : std::nullopt);
    return number(value ? std::optional{value->high} : std::nullopt);
  }

  [[nodiscard]] std::string end() const { return line_ + "\r\n"; }

 private:
  void separate() {
    if (!first_) line_ += ',';
    first_ = false;
  }

  std::string line_;
  bool first_ = true;
};

/// One side of a comparison.
void summary_cells(Line& line, const Material& material, const std::optional<std::size_t>& group,
                   std::size_t q) {
  const analysis::GroupQuantity* own = group ? &material.groups[*group].quantities[q] : nullptr;
  const analysis::Replicates none;
  const bool has = own != nullptr && own->replicates;
  const analysis::Replicates& replicates = has ? *own->replicates : none;
  line.number(std::optional{replicates.count});
  line.number(has ? std::optional{replicates.mean} : std::nullopt);
  line.number(replicates.standard_deviation)
      .number(replicates.repeatability)
      .interval(replicates.mean_interval);
}

/// The same of S − K by cycle, whose scatter is not one of single tests.
void by_cycle_cells(Line& line, const Material& material, const std::optional<std::size_t>& group) {
  const analysis::PooledDeltaMu none;
  const analysis::PooledDeltaMu& pooled = group ? material.groups[*group].by_cycle : none;
  line.number(std::optional{pooled.test_count}).number(pooled.mean.value).text("").text("");
  line.interval(analysis::mean_interval(pooled));
}

void welch_cells(Line& line, const std::optional<analysis::Welch>& welch) {
  line.number(welch ? std::optional{welch->difference} : std::nullopt);
  line.interval(welch ? std::optional{welch->interval} : std::nullopt);
  line.number(welch ? std::optional{welch->t} : std::nullopt);
  line.number(welch ? std::optional{welch->degrees_of_freedom} : std::nullopt);
  line.number(welch ? std::optional{welch->p} : std::nullopt);
}

}  // namespace

std::string report_csv(const Material& material) {
  Line header;
  header.text("file").text("title").text("method").text("estimator").text("pull_speed").text("regime");
  std::string text;
  std::vector<const analysis::PooledDeltaMu*> by_cycle(material.tests.size());
  for (const analysis::SpeedGroup& group : material.groups) {
    for (const std::size_t test : group.tests) by_cycle[test] = &group.by_cycle;
  }
  std::size_t cells = 12;  // Beside the results.
  for (std::size_t i = 0; i < material.tests.size(); ++i) {
    const analysis::MeasuredTest& measured = material.measured[i];
    Line line;
    const ReportedTest& test = material.tests[i];
    line.text(test.file).text(test.title).text(test.method).text(test.estimator);
    line.number(measured.pull_speed_m_per_s).text(model::name(measured.results.regime));
    std::string reasons;
    analysis::for_each_result(
        measured.results, [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
          if (i == 0) {
            header.text(name.name);
            ++cells;
          }
          line.number(estimate.value);
          if (!estimate.value) {
            reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", name.name, estimate.reason);
          }
        });
    if (i == 0) {
      for (const char* name : {"at_speed_delta_mu_by_cycle", "at_speed_delta_mu_by_cycle_standard_error",
                               "at_speed_slips", "at_speed_escaped"}) {
        header.text(name);
      }
      text = header.text("absent").text("voided").end();
    }
    const analysis::PooledDeltaMu& pooled = *by_cycle[i];
    line.number(pooled.mean.value).number(pooled.mean.standard_error);
    line.number(std::optional{pooled.slip_count}).number(std::optional{pooled.escaped_count});
    text += line.text(reasons).text("").end();
  }
  // No numbers, so that nobody averages them.
  for (const VoidedTest& test : material.voided) {
    Line line;
    line.text(test.file);
    for (std::size_t cell = 1; cell + 1 < cells; ++cell) line.text("");
    text += line.text(test.voiding.reason).end();
  }
  return text;
}

std::string comparison_csv(const Material& a, const Material& b, const MaterialComparison& comparison) {
  Line header;
  header.text("pull_speed").text("quantity").text("unit");
  for (const char* side : {"a", "b"}) {
    for (const char* name :
         {"count", "mean", "standard_deviation", "repeatability", "mean_low", "mean_high"}) {
      header.text(fmt::format("{}_{}", side, name));
    }
  }
  for (const char* name :
       {"difference", "difference_low", "difference_high", "t", "degrees_of_freedom", "p", "hedges_g",
        "hedges_g_low", "hedges_g_high", "tests_needed_80", "tests_needed_90", "reason"}) {
    header.text(name);
  }
  std::string text = header.end();
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const analysis::SpeedPair& pair = comparison.pairs[i];
    Line by_cycle;
    by_cycle.number(pair.pull_speed_m_per_s).text("delta_mu_by_cycle").text("1");
    by_cycle_cells(by_cycle, a, pair.a);
    by_cycle_cells(by_cycle, b, pair.b);
    welch_cells(by_cycle, comparison.by_cycle[i].welch);
    for (int empty = 0; empty < 5; ++empty) by_cycle.text("");  // No g, no number of tests.
    text += by_cycle.text(comparison.by_cycle[i].reason).end();
    for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
      const analysis::Quantity& quantity = analysis::quantities()[q];
      const auto& [welch, effect, needed, reason] = comparison.comparisons[i][q];
      Line line;
      line.number(comparison.pairs[i].pull_speed_m_per_s).text(quantity.name).text(quantity.unit);
      summary_cells(line, a, comparison.pairs[i].a, q);
      summary_cells(line, b, comparison.pairs[i].b, q);
      welch_cells(line, welch);
      line.number(effect ? std::optional{effect->g} : std::nullopt);
      line.interval(effect ? effect->interval : std::nullopt);
      line.number(needed ? needed->for_80_percent : std::nullopt);
      line.number(needed ? needed->for_90_percent : std::nullopt);
      text += line.text(reason).end();
    }
  }
  return text;
}

}  // namespace stickslip::report

#include "report/report_json.hpp"

#include <optional>
#include <string>
#include <utility>

#include "io/or_null.hpp"
#include "io/pooled_json.hpp"
#include "io/results_json.hpp"
#include "report/budget_forms.hpp"
#include "report/ramp_text.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::report {
namespace {

using Json = nlohmann::ordered_json;
using analysis::Comparison;
using analysis::GroupQuantity;
using analysis::Interval;

Json interval_json(const std::optional<Interval>& interval) {
  return interval ? Json::array({interval->low, interval->high}) : Json(nullptr);
}

Json test_json(const ReportedTest& test, const analysis::MeasuredTest& measured) {
  Json json{{"file", test.file},
            {"title", test.title},
            {"method", test.method},
            {"estimator", test.estimator},
            {"departures", test.departures},
            {"pull_speed", io::or_null(measured.pull_speed_m_per_s)},
            {"pull_speed_text", test.speed.empty() ? "speed not known" : test.speed}};
  json.update(io::results_json(measured.results, true));
  if (!test.sample.metadata.empty()) json["metadata"] = test.sample.metadata;
  json["budgets"] = budgets_json(budgets_of(measured.results, measured.budget_facts));
  if (std::string ramp = ramp_text(measured.results); !ramp.empty()) json["ramp"] = std::move(ramp);
  return json;
}

Json quantity_json(const Material& material, const GroupQuantity& group, const analysis::Quantity& quantity) {
  Json json{{"unit", quantity.unit}, {"count", group.tests.size()}};
  if (const std::optional<analysis::Replicates>& own = group.replicates) {
    json["mean"] = own->mean;
    json["standard_deviation"] = io::or_null(own->standard_deviation);
    json["repeatability"] = io::or_null(own->repeatability);
    json["confidence_interval"] = interval_json(own->mean_interval);
    json["coverage_factor"] = io::or_null(own->coverage_factor);
    json["outlier"] = nullptr;
    if (own->outlier) {
      json["outlier"] = {{"file", material.tests[group.tests[own->outlier->index]].file},
                         {"statistic", own->outlier->statistic},
                         {"critical", own->outlier->critical}};
    }
  } else {
    for (const char* key : {"mean", "standard_deviation", "repeatability", "confidence_interval",
                            "coverage_factor", "outlier"}) {
      json[key] = nullptr;
    }
  }
  json["systematic_uncertainty"] = io::or_null(group.systematic_uncertainty);
  json["absent"] = Json::array();
  for (const analysis::Absence& absence : group.absences) {
    json["absent"].push_back({{"file", material.tests[absence.test].file}, {"reason", absence.reason}});
  }
  return json;
}

Json welch_json(const std::optional<analysis::Welch>& welch) {
  Json json;
  json["difference"] = welch ? Json(welch->difference) : Json(nullptr);
  json["confidence_interval"] = welch ? interval_json(welch->interval) : Json(nullptr);
  json["t"] = welch ? Json(welch->t) : Json(nullptr);
  json["degrees_of_freedom"] = welch ? Json(welch->degrees_of_freedom) : Json(nullptr);
  json["p"] = welch ? Json(welch->p) : Json(nullptr);
  return json;
}

Json comparison_json(const Comparison& comparison) {
  const auto& [welch, effect, needed, reason] = comparison;
  Json json = welch_json(welch);
  json["hedges_g"] = effect ? Json(effect->g) : Json(nullptr);
  json["hedges_g_interval"] = effect ? interval_json(effect->interval) : Json(nullptr);
  json["tests_needed_80"] = needed ? io::or_null(needed->for_80_percent) : Json(nullptr);
  json["tests_needed_90"] = needed ? io::or_null(needed->for_90_percent) : Json(nullptr);
  if (!reason.empty()) json["reason"] = reason;
  return json;
}

}  // namespace

Json report_json(const Material& material) {
  Json json{{"tests", Json::array()},
            {"groups", Json::array()},
            {"voided", Json::array()},
            {"limits", Json::array()}};
  json["form"] = Json::array();
  for (const FormLine& line : form_of(material)) {
    json["form"].push_back({{"name", line.name},
                            {"label", line.label},
                            {"values", line.values},
                            {"not_stated", line.not_stated},
                            {"text", line.text}});
  }
  json["verdict"] = verdict_of(material);
  json["not_pooled"] = not_pooled_text(material);
  for (const VoidedTest& test : material.voided) {
    json["voided"].push_back({{"file", test.file},
                              {"reason", test.voiding.reason},
                              {"by", test.voiding.who},
                              {"at", test.voiding.at}});
  }
  for (const daemon::LimitVerdict& own : material.limits) {
    json["limits"].push_back({{"quantity", own.quantity},
                              {"lowest", io::or_null(own.limits.lowest)},
                              {"highest", io::or_null(own.limits.highest)},
                              {"pass", own.passes()},
                              {"outside", own.outside},
                              {"absent", own.absent}});
  }
  for (std::size_t i = 0; i < material.tests.size(); ++i) {
    json["tests"].push_back(test_json(material.tests[i], material.measured[i]));
  }
  for (const analysis::SpeedGroup& group : material.groups) {
    Json of_group{{"pull_speed", io::or_null(group.pull_speed_m_per_s)},
                  {"pull_speed_text", speed_of(material, group)},
                  {"text", group_text(material, group)},
                  {"grades", group.grades},
                  {"regimes", Json::array()},
                  {"tests", group.tests},
                  {"delta_mu_by_cycle", io::pooled_json(group.by_cycle)}};
    for (const model::Regime regime : group.regimes) of_group["regimes"].push_back(model::name(regime));
    for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
      const analysis::Quantity& quantity = analysis::quantities()[q];
      of_group["quantities"][std::string{quantity.name}] =
          quantity_json(material, group.quantities[q], quantity);
    }
    of_group["budgets"] = budgets_json(budgets_of(material.measured, group));
    json["groups"].push_back(std::move(of_group));
  }
  for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
    json["pooled_standard_deviation"][std::string{analysis::quantities()[q].name}] =
        io::or_null(analysis::pooled_over_groups(material.groups, q));
  }
  return json;
}

Json comparison_json(const Material& a, const Material& b, const MaterialComparison& comparison) {
  Json json;
  for (const auto& [key, material] : {std::pair{"a", &a}, std::pair{"b", &b}}) {
    json[key] = {{"label", material->label}};
    json[key].update(report_json(*material));
  }
  json["comparisons"] = Json::array();
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const RegimeComparison& regime = comparison.regimes[i];
    const analysis::SpeedPair& pair = comparison.pairs[i];
    Json of_pair{
        {"pull_speed", io::or_null(pair.pull_speed_m_per_s)},
        {"pull_speed_text", pair.a ? speed_of(a, a.groups[*pair.a]) : speed_of(b, b.groups[*pair.b])},
        {"regime",
         {{"a_sticking", regime.a.sticking},
          {"a_sliding", regime.a.sliding},
          {"b_sticking", regime.b.sticking},
          {"b_sliding", regime.b.sliding},
          {"p", io::or_null(regime.p)}}},
        {"delta_mu_by_cycle", welch_json(comparison.by_cycle[i].welch)}};
    if (const std::string& reason = comparison.by_cycle[i].reason; !reason.empty())
      of_pair["delta_mu_by_cycle"]["reason"] = reason;
    for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
      of_pair["quantities"][std::string{analysis::quantities()[q].name}] =
          comparison_json(comparison.comparisons[i][q]);
    }
    json["comparisons"].push_back(std::move(of_pair));
  }
  json["combined"] = Json::object();
  for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
    const auto& combined = comparison.combined[q];
    json["combined"][std::string{analysis::quantities()[q].name}] =
        combined ? Json{{"p", combined->p}, {"speeds", combined->speed_count}} : Json(nullptr);
  }
  return json;
}

}  // namespace stickslip::report

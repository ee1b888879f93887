#include "daemon/types/calibration_json.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "core/record/finding_json.hpp"
#include "daemon/types/plan_json.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;

Json said(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json point_json(double mass_kg, double force_N, double voltage_V, std::optional<double> standard_error_V,
                double residual_V, const std::string& refused) {
  return {{"mass", mass_kg},
          {"force", force_N},
          {"voltage", voltage_V},
          {"standard_error", known_json(standard_error_V)},
          {"residual", known_json(residual_V)},
          {"refused", refused}};
}

Json in_use_json(const CalibrationView& view) {
  const record::CalibrationFacts& facts = view.facts;
  Json points = Json::array();
  for (std::size_t i = 0; i < facts.mass_kg.size(); ++i) {
    points.push_back(point_json(facts.mass_kg[i], facts.force_N[i], facts.voltage_V[i],
                                facts.voltage_standard_error_V[i], facts.point_residual_V[i],
                                facts.refused[i]));
  }
  return {{"gain", view.load_cell.gain_N_per_V},
          {"gain_standard_error", known_json(facts.gain_standard_error_N_per_V)},
          {"zero", view.load_cell.zero_V},
          {"zero_standard_error", known_json(facts.zero_standard_error_V)},
          {"residual", known_json(facts.residual_V)},
          {"hysteresis", known_json(facts.hysteresis_V)},
          {"date", said(facts.date)},
          {"expires", said(facts.expires)},
          {"expired", view.expired},
          {"certificate", said(facts.certificate)},
          {"replaced_gain", known_json(facts.replaced_gain_N_per_V)},
          {"points", std::move(points)}};
}

Json session_json(const CalibrationSession& session) {
  const daq::LoadCellFit& fit = session.weighed.fit;
  const auto of = [&fit](double value) { return fit.load_cell ? Json(value) : Json(nullptr); };
  const daq::LoadCell cell = fit.load_cell.value_or(daq::LoadCell{});
  const auto if_fit = [&fit](std::optional<double> value) {
    return fit.load_cell ? known_json(value) : Json(nullptr);
  };
  std::vector<base::Finding> findings = session.weighed.findings;
  if (session.gain_change) base::add(findings, daq::finding(*session.gain_change));
  Json json{{"controller", session.who},
            {"settle", session.times.settle_s},
            {"reading", session.times.reading_s},
            {"mass_being_read", known_json(session.being_read_kg)},
            {"points", points_json(session.weighed)},
            {"gain", of(cell.gain_N_per_V)},
            {"gain_standard_error", if_fit(fit.gain_standard_error_N_per_V)},
            {"zero", of(cell.zero_V)},
            {"zero_standard_error", if_fit(fit.zero_standard_error_V)},
            {"residual", if_fit(fit.residual_V)},
            {"hysteresis", if_fit(fit.hysteresis_V)},
            {"gain_change", gain_change_json(session.gain_change)},
            {"missing", said(fit.reason)}};
  record::put_findings(findings, json);
  return json;
}

}  // namespace

base::Result<daq::WeighingTimes> weighing_times_of(const Json& json, Warnings* warnings) {
  daq::WeighingTimes times;
  for (const auto& [key, time_s] : {std::pair{"settle", &times.settle_s}, {"reading", &times.reading_s}}) {
    const auto value =
        quantity_at(json, key, base::Dimension::kTime, base::BareNumber::kSiWithWarning, warnings);
    if (!value) return tl::unexpected(value.error());
    if (!*value) continue;
    if (!(**value >= 0.0 && **value <= kLongestWeighing_s))
      return base::usage_error("{}: {} s; must be 0 to {} s", key, **value, kLongestWeighing_s);
    *time_s = **value;
  }
  return times;
}

base::Result<double> mass_of(const Json& json) {
  // A number alone was kg, and a technician who reads "500" on a weight means g.
  const auto mass_kg =
      quantity_at(json, "mass", base::Dimension::kMass, base::BareNumber::kOnlyZero, nullptr);
  if (!mass_kg) return tl::unexpected(mass_kg.error());
  if (!*mass_kg) return base::usage_error("mass: is missing: what hangs? \"500 g\", or 0 for nothing");
  if (!(**mass_kg >= 0.0 && **mass_kg <= daq::kHeaviestWeight_kg))
    return base::usage_error("mass: {} kg; must be 0 to {} kg", **mass_kg, daq::kHeaviestWeight_kg);
  return **mass_kg;
}

base::Result<io::CalibrationPaper> paper_of(const Json& json) {
  io::CalibrationPaper paper;
  if (json.contains("certificate")) {
    const Json& text = json.at("certificate");
    if (!text.is_string()) return base::usage_error("certificate: must be text");
    paper.certificate = text.get<std::string>();
    if (const std::string why = base::name_refusal(paper.certificate); !why.empty())
      return base::usage_error("certificate: {}", why);
  }
  if (json.contains("valid_days")) {
    const Json& days = json.at("valid_days");
    if (!days.is_number() || !(days >= 0.0) || !(days <= io::kLongestValid_days))
      return base::usage_error("valid_days: must be 0 (for ever) to {}", io::kLongestValid_days);
    paper.valid_days = days.get<double>();
  }
  if (json.contains("confirm")) {
    if (!json.at("confirm").is_boolean()) return base::usage_error("confirm: must be true or false");
    paper.confirms_gain = json.at("confirm").get<bool>();
  }
  return paper;
}

Json known_json(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json gain_change_json(const std::optional<daq::GainChange>& change) {
  if (!change) return nullptr;
  return {{"code", daq::kGainChangeCode}, {"text", daq::to_text(*change)},
          {"gain", change->gain_N_per_V}, {"gain_in_use", change->in_use_N_per_V},
          {"ratio", change->ratio()},     {"limit", daq::kLargestGainChange}};
}

Json points_json(const daq::WeighedCalibration& weighed) {
  Json points = Json::array();
  for (const daq::WeighedPoint& point : weighed.points) {
    points.push_back(point_json(point.reading.mass_kg, point.force_N, point.reading.voltage_V,
                                point.reading.standard_error_V, point.residual_V, point.refused));
  }
  return points;
}

Json calibration_json(const CalibrationView& view) {
  return {{"in_use", in_use_json(view)},
          {"folder", said(view.folder)},
          {"file", said(view.file)},
          {"weighing", view.session ? session_json(*view.session) : Json(nullptr)}};
}

}  // namespace stickslip::daemon

#include "daemon/types/calibration_json.hpp"

#include <cmath>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/quantity.hpp"
#include "core/base/text.hpp"
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
          {"points", std::move(points)}};
}

Json session_json(const CalibrationSession& session) {
  const daq::LoadCellFit& fit = session.weighed.fit;
  const auto of = [&fit](double value) { return fit.load_cell ? Json(value) : Json(nullptr); };
  const daq::LoadCell cell = fit.load_cell.value_or(daq::LoadCell{});
  const auto if_fit = [&fit](std::optional<double> value) {
    return fit.load_cell ? known_json(value) : Json(nullptr);
  };
  return {{"controller", session.who},
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
          {"findings", session.weighed.findings},
          {"missing", said(fit.reason)}};
}

/// Reads a quantity: a number, or text with a unit.
base::Result<double> quantity_of(const char* key, const Json& value, base::Dimension dimension,
                                 const char* example) {
  if (value.is_number()) return value.get<double>();
  if (!value.is_string())
    return base::usage_error("{}: must be a number, or text such as \"{}\"", key, example);
  auto quantity = base::parse_quantity(value.get<std::string>(), dimension);
  if (!quantity) return base::usage_error("{}: {}", key, quantity.error().message);
  return quantity;
}

}  // namespace

base::Result<daq::WeighingTimes> weighing_times_of(const Json& json) {
  daq::WeighingTimes times;
  for (const auto& [key, time_s] : {std::pair{"settle", &times.settle_s}, {"reading", &times.reading_s}}) {
    if (!json.contains(key)) continue;
    const auto value = quantity_of(key, json.at(key), base::Dimension::kTime, "2 s");
    if (!value) return tl::unexpected(value.error());
    if (!(*value >= 0.0 && *value <= kLongestWeighing_s))
      return base::usage_error("{}: {} s; must be 0 to {} s", key, *value, kLongestWeighing_s);
    *time_s = *value;
  }
  return times;
}

base::Result<double> mass_of(const Json& json) {
  if (!json.contains("mass")) return base::usage_error("mass: is missing: what hangs? 0 for nothing");
  auto mass_kg = quantity_of("mass", json.at("mass"), base::Dimension::kMass, "500 g");
  if (!mass_kg) return mass_kg;
  if (!(*mass_kg >= 0.0 && *mass_kg <= daq::kHeaviestWeight_kg))
    return base::usage_error("mass: {} kg; must be 0 to {} kg", *mass_kg, daq::kHeaviestWeight_kg);
  return mass_kg;
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
  return paper;
}

Json known_json(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
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

#include "daemon/types/batch_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/json_text.hpp"
#include "io/library.hpp"
#include "io/method_file.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/results.hpp"
#include "core/base/wording.hpp"
#include "core/record/method_text.hpp"
#include "daemon/types/plan_json.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMethod = "method";
constexpr const char* kSpeeds = "pull_speeds";
constexpr const char* kReplicates = "replicates";
constexpr const char* kSlides = "slides";
constexpr const char* kLimits = "limits";
constexpr std::size_t kMostSpeeds = 100;

/// Reads a method: the name of a shipped one, or the text of a record's process/method.
base::Result<model::Method> method_of(const std::string& text) {
  if (!io::is_method_name(text)) return record::method_from_text(text);
  const auto file = io::find_in(io::kMethods, text, "");
  if (!file) return tl::unexpected(file.error());
  const auto read = io::load_method(*file);
  if (!read) return tl::unexpected(read.error());
  return read->method;
}

/// Dimension of a result; nullopt: there is no such result.
std::optional<base::Dimension> dimension_of(std::string_view name) {
  std::optional<base::Dimension> found;
  const analysis::TestResults any;
  analysis::for_each_result(any, [&](const analysis::ResultName& own, const analysis::Estimate&) {
    if (own.name == name) found = base::dimension_of_unit(own.unit);
  });
  return found;
}

base::Result<std::int64_t> count_of(const char* key, const Json& value) {
  if (!value.is_number_integer() || value < 1 || value > kMostSteps)
    return base::usage_error("{}: must be a whole number from 1 to {}", key, kMostSteps);
  return value.get<std::int64_t>();
}

/// \param key  kSpeeds, or that with the unit, whose numbers need none.
base::Result<std::vector<double>> speeds_of(const std::string& key, const Json& value, Warnings* warnings) {
  const bool with_unit = key != kSpeeds;
  if (!value.is_array() || value.size() > kMostSpeeds) {
    return base::usage_error("{}: must be a list of at most {} speeds, such as [{}]", key, kMostSpeeds,
                             with_unit ? "0.00508" : "\"12 in/min\"");
  }
  std::vector<double> speeds;
  for (const Json& one : value) {
    if (with_unit && !one.is_number()) return base::usage_error("{}: must be numbers", key);
    const base::Result<double> speed =
        quantity_of(key, one, base::Dimension::kSpeed,
                    with_unit ? base::BareNumber::kSi : base::BareNumber::kSiWithWarning, warnings);
    if (!speed) return tl::unexpected(speed.error());
    if (const auto checked = check_pull_speed(key, *speed); !checked) return tl::unexpected(checked.error());
    if (std::find(speeds.begin(), speeds.end(), *speed) != speeds.end())
      return base::usage_error("{}: {} m/s stands there twice; replicates say how often", key, *speed);
    speeds.push_back(*speed);
  }
  return speeds;
}

base::Result<std::map<std::string, ResultLimits>> limits_of(const Json& value, Warnings* warnings) {
  if (!value.is_object())
    return base::usage_error("{}: must be an object such as {{\"mu_k\": {{\"highest\": 0.4}}}}", kLimits);
  std::map<std::string, ResultLimits> all;
  for (const auto& [name, pair] : value.items()) {
    const std::string shown = base::one_line(name, 60);
    const auto dimension = dimension_of(name);
    if (!dimension) return base::usage_error("{}: there is no result called \"{}\"", kLimits, shown);
    if (!pair.is_object()) return base::usage_error("{}: {} must have lowest or highest", kLimits, shown);
    ResultLimits limits;
    for (const auto& [side, number] : pair.items()) {
      if (side != "lowest" && side != "highest")
        return base::usage_error("{}: {} has lowest and highest, no \"{}\"", kLimits, shown,
                                 base::one_line(side, 60));
      if (number.is_null()) continue;
      if (*dimension == base::Dimension::kDimensionless && !number.is_number())
        return base::usage_error("{}: {}, {} must be a number", kLimits, shown, side);
      const auto limit = quantity_of(fmt::format("{}: {}, {}", kLimits, shown, side), number, *dimension,
                                     base::BareNumber::kSiWithWarning, warnings);
      if (!limit) return tl::unexpected(limit.error());
      (side == "lowest" ? limits.lowest : limits.highest) = *limit;
    }
    if (limits.lowest && limits.highest && *limits.lowest > *limits.highest) {
      return base::usage_error("{}: {}, lowest {} is above highest {}", kLimits, shown, *limits.lowest,
                               *limits.highest);
    }
    all[name] = limits;
  }
  return all;
}

}  // namespace

Json batch_plan_json(const BatchPlan& plan) {
  // The facts of the sample by the words of the plan of single tests.
  Json json = plan_json({plan.sample, std::nullopt, std::nullopt});
  for (const char* of_one_test : {"replicate", "pull_speed"}) json.erase(of_one_test);
  json[kMethod] = plan.method.empty() ? Json(nullptr) : Json(plan.method);
  json[kSpeeds] = plan.pull_speeds_m_per_s;
  json[kReplicates] = plan.replicates;
  json[kSlides] = plan.slides;
  json[kLimits] = Json::object();
  for (const auto& [name, limits] : plan.limits) {
    json[kLimits][name] = {{"lowest", limits.lowest ? Json(*limits.lowest) : Json(nullptr)},
                           {"highest", limits.highest ? Json(*limits.highest) : Json(nullptr)}};
  }
  return json;
}

base::Result<BatchPlan> batch_plan_of(const Json& json, Warnings* warnings) {
  BatchPlan plan;
  Json sample = Json::object();
  std::optional<model::Method> method;
  bool has_speeds = false;
  bool has_replicates = false;
  for (const auto& [key, value] : json.items()) {
    if (value.is_null()) continue;
    if (key == kMethod) {
      if (!value.is_string()) return base::usage_error("{}: must be text", kMethod);
      auto known = method_of(value.get<std::string>());
      if (!known) return base::usage_error("{}: {}", kMethod, known.error().message);
      method = *std::move(known);
      plan.method = record::method_text(*method);
    } else if (key == kSpeeds || key == key_with_unit(kSpeeds, base::Dimension::kSpeed)) {
      if (has_speeds) return base::usage_error("{}: the speeds are given twice", key);
      auto speeds = speeds_of(key, value, warnings);
      if (!speeds) return tl::unexpected(speeds.error());
      plan.pull_speeds_m_per_s = *std::move(speeds);
      has_speeds = true;
    } else if (key == kReplicates || key == kSlides) {
      const auto count = count_of(key.c_str(), value);
      if (!count) return tl::unexpected(count.error());
      (key == kSlides ? plan.slides : plan.replicates) = *count;
      has_replicates = has_replicates || key == kReplicates;
    } else if (key == kLimits) {
      auto limits = limits_of(value, warnings);
      if (!limits) return tl::unexpected(limits.error());
      plan.limits = *std::move(limits);
    } else if (key == "name" || key == "grade" || key == "direction" || key == "side" || key == "operator" ||
               key == "facts") {
      sample[key] = value;
    } else {
      return base::usage_error(
          "\"{}\": there is no such key; there are name, grade, direction, side, operator, method, "
          "pull_speeds, pull_speeds_m_per_s, replicates, slides, limits, facts",
          base::one_line(key, 60));
    }
  }
  const base::Result<Plan> facts = plan_of(sample);
  if (!facts) return tl::unexpected(facts.error());
  plan.sample = facts->sample;
  if (plan.sample.name.empty()) return base::usage_error("name: is missing: what is measured?");
  if (method && !has_speeds && method->pull_speed_m_per_s)
    plan.pull_speeds_m_per_s = {method->pull_speed_m_per_s->value};
  if (method && !has_replicates && method->replicates) plan.replicates = *method->replicates;
  const std::int64_t speeds = std::max<std::int64_t>(1, std::ssize(plan.pull_speeds_m_per_s));
  if (plan.replicates * plan.slides > kMostSteps / speeds) {
    return base::usage_error("{} speeds, {} replicates and {} slides are more than {} tests", speeds,
                             plan.replicates, plan.slides, kMostSteps);
  }
  return plan;
}

Json step_json(const BatchStep& step) {
  return {{"pull_speed", step.pull_speed_m_per_s ? Json(*step.pull_speed_m_per_s) : Json(nullptr)},
          {"replicate", step.replicate},
          {"slide", step.slide}};
}

Json voiding_json(const Voiding* voiding) {
  if (voiding == nullptr) return nullptr;
  return {{"reason", voiding->reason}, {"by", voiding->who}, {"at", voiding->at}};
}

std::string line_of(const BatchEvent& event) {
  Json json{{"at", event.at}, {"by", event.who}};
  if (const auto* begun = std::get_if<BatchBegun>(&event.what)) {
    json.update({{"event", "begun"}, {"batch", begun->batch}, {"plan", batch_plan_json(begun->plan)}});
  } else if (const auto* ended = std::get_if<BatchEnded>(&event.what)) {
    json.update({{"event", "ended"}, {"batch", ended->batch}});
  } else if (const auto* recorded = std::get_if<TestRecorded>(&event.what)) {
    json.update({{"event", "recorded"}, {"batch", recorded->batch}, {"record", recorded->test.record}});
    json.update(step_json(recorded->test.step));
  } else if (const auto* voided = std::get_if<TestVoided>(&event.what)) {
    json.update({{"event", "voided"}, {"record", voided->record}, {"reason", voided->reason}});
  } else {
    json.update({{"event", "restored"}, {"record", std::get<TestRestored>(event.what).record}});
  }
  return io::json_text(json);
}

base::Result<BatchEvent> event_of(std::string_view line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return base::usage_error("is no JSON object");
  BatchEvent event;
  const auto kind = text_at(json, "event");
  if (!kind) return tl::unexpected(kind.error());
  for (const auto& [key, text] : {std::pair{"at", &event.at}, {"by", &event.who}}) {
    auto found = text_at(json, key);
    if (!found) return tl::unexpected(found.error());
    *text = *std::move(found);
  }
  const bool of_batch = *kind == "begun" || *kind == "ended" || *kind == "recorded";
  const bool of_record = *kind == "recorded" || *kind == "voided" || *kind == "restored";
  if (!of_batch && !of_record)
    return base::usage_error("\"{}\" is no event this program knows", base::one_line(*kind, 60));
  std::string batch;
  std::string record;
  for (const auto& [wanted, key, text] :
       {std::tuple{of_batch, "batch", &batch}, std::tuple{of_record, "record", &record}}) {
    if (!wanted) continue;
    auto found = text_at(json, key);
    if (!found) return tl::unexpected(found.error());
    *text = *std::move(found);
  }
  if (*kind == "begun") {
    auto plan = batch_plan_of(json.value("plan", Json::object()));
    if (!plan) return tl::unexpected(plan.error());
    event.what = BatchBegun{batch, *std::move(plan)};
  } else if (*kind == "ended") {
    event.what = BatchEnded{batch};
  } else if (*kind == "recorded") {
    BatchStep step;
    if (const Json& speed = json.value("pull_speed", Json()); speed.is_number())
      step.pull_speed_m_per_s = speed.get<double>();
    for (const auto& [key, number] : {std::pair{"replicate", &step.replicate}, {"slide", &step.slide}}) {
      const auto count = count_of(key, json.value(key, Json()));
      if (!count) return tl::unexpected(count.error());
      *number = *count;
    }
    event.what = TestRecorded{batch, {record, step}};
  } else if (*kind == "voided") {
    auto reason = text_at(json, "reason");
    if (!reason) return tl::unexpected(reason.error());
    event.what = TestVoided{record, *std::move(reason)};
  } else {
    event.what = TestRestored{record};
  }
  return event;
}

}  // namespace stickslip::daemon

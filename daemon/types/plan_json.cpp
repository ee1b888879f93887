#include "daemon/types/plan_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/quantity.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/model/largest_settings.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;

/// Largest replicate number, as in the configuration.
constexpr std::int64_t kMostReplicates = 1'000'000;

constexpr std::array<std::pair<const char*, std::string record::SampleFacts::*>, 5> kTexts{{
    {"name", &record::SampleFacts::name},
    {"grade", &record::SampleFacts::grade},
    {"direction", &record::SampleFacts::direction},
    {"side", &record::SampleFacts::side},
    {"operator", &record::SampleFacts::operator_name},
}};
constexpr const char* kReplicate = "replicate";
constexpr const char* kSpeed = "pull_speed";
constexpr const char* kFacts = "facts";

/// {"temperature": "23 degC", "lot": null}; an empty text stands for null.
base::Result<std::map<std::string, std::string>> facts_of(const Json& json) {
  if (!json.is_object()) return base::usage_error("{}: must be an object of texts", kFacts);
  std::map<std::string, std::string> facts;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string() && !value.is_null()) {
      return base::usage_error("{}: {}: must be text, with its unit if it has one", kFacts,
                               base::one_line(key));
    }
    record::Metadata checked;
    std::string text = value.is_null() ? std::string{} : value.get<std::string>();
    if (const auto set = record::set_fact(checked, key, text); !set)
      return base::usage_error("{}: {}", kFacts, set.error().message);
    facts.emplace(key, std::move(text));
  }
  return facts;
}

}  // namespace

base::Result<void> check_pull_speed(std::string_view key, double speed_m_per_s) {
  if (speed_m_per_s > 0.0 && speed_m_per_s <= model::kFastestPull_m_per_s) return {};
  return base::usage_error("{}: {} m/s; must be above 0 and at most {} m/s", key, speed_m_per_s,
                           model::kFastestPull_m_per_s);
}

base::Result<std::map<std::string, std::string>> facts_in(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return base::usage_error("must be JSON, such as {{\"temperature\": \"23 degC\"}}");
  return facts_of(json);
}

Json plan_json(const Plan& plan) {
  Json json;
  for (const auto& [key, member] : kTexts) {
    const std::string& text = plan.sample.*member;
    json[key] = text.empty() ? Json(nullptr) : Json(text);
  }
  json[kReplicate] = plan.sample.replicate ? Json(*plan.sample.replicate) : Json(nullptr);
  json[kSpeed] = plan.pull_speed_m_per_s ? Json(*plan.pull_speed_m_per_s) : Json(nullptr);
  json[kFacts] = plan.sample.metadata;
  return json;
}

base::Result<Plan> plan_of(const Json& json, Warnings* warnings) {
  Plan plan;
  for (const auto& [key, value] : json.items()) {
    if (value.is_null()) continue;
    const auto text = std::find_if(kTexts.begin(), kTexts.end(),
                                   [&key = key](const auto& own) { return own.first == key; });
    if (text != kTexts.end()) {
      if (!value.is_string()) return base::usage_error("{}: must be text", key);
      const std::string said = value.get<std::string>();
      if (const std::string refusal = base::name_refusal(said); !refusal.empty())
        return base::usage_error("{}: {}", key, refusal);
      plan.sample.*(text->second) = said;
    } else if (key == kReplicate) {
      if (!value.is_number_integer() || value.get<std::int64_t>() < 1 ||
          value.get<std::int64_t>() > kMostReplicates) {
        return base::usage_error("{}: must be a whole number from 1 to {}", key, kMostReplicates);
      }
      plan.sample.replicate = value.get<std::int64_t>();
    } else if (key == kSpeed || key == key_with_unit(kSpeed, base::Dimension::kSpeed)) {
      const auto speed =
          quantity_at(json, kSpeed, base::Dimension::kSpeed, base::BareNumber::kSiWithWarning, warnings);
      if (!speed) return tl::unexpected(speed.error());
      if (const auto checked = check_pull_speed(key, speed->value()); !checked)
        return tl::unexpected(checked.error());
      plan.pull_speed_m_per_s = *speed;
    } else if (key == kFacts) {
      const auto facts = facts_of(value);
      if (!facts) return tl::unexpected(facts.error());
      for (const auto& [fact, stated] : *facts) {
        if (const auto set = record::set_fact(plan.sample.metadata, fact, stated); !set)
          return base::usage_error("{}: {}", kFacts, set.error().message);
      }
    } else {
      return base::usage_error(
          "\"{}\": there is no such key; there are name, grade, direction, side, operator, replicate, "
          "pull_speed, pull_speed_m_per_s, facts",
          base::one_line(key));
    }
  }
  return plan;
}

}  // namespace stickslip::daemon

#include "daemon/types/quantity_json.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "daemon/types/batch_json.hpp"
#include "daemon/types/calibration_json.hpp"
#include "daemon/types/plan_json.hpp"

namespace stickslip::daemon {
namespace {

using base::BareNumber;
using base::Dimension;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using Json = nlohmann::ordered_json;

base::Result<std::optional<double>> mass_at(const char* text, BareNumber bare, Warnings* warnings = nullptr) {
  return quantity_at(Json::parse(text), "mass", Dimension::kMass, bare, warnings);
}

TEST(QuantityJson, KeyNamesTheUnit) {
  EXPECT_EQ(key_with_unit("mass", Dimension::kMass), "mass_kg");
  EXPECT_EQ(key_with_unit("settle", Dimension::kTime), "settle_s");
  EXPECT_EQ(key_with_unit("pull_speed", Dimension::kSpeed), "pull_speed_m_per_s");
}

TEST(QuantityJson, IsTextWithAUnitOrANumberUnderTheKeyWithTheUnit) {
  EXPECT_EQ(mass_at(R"({"mass": "500 g"})", BareNumber::kRefused).value(), 0.5);
  EXPECT_EQ(mass_at(R"({"mass_kg": 0.5})", BareNumber::kRefused).value(), 0.5);
  EXPECT_EQ(mass_at(R"({"mass": null})", BareNumber::kRefused).value(), std::nullopt);
  EXPECT_EQ(mass_at("{}", BareNumber::kRefused).value(), std::nullopt);
}

TEST(PlanJson, HoldsFactsAsTextsWithTheirUnits) {
  const auto plan =
      plan_of(Json::parse(R"({"facts": {"temperature": "23 degC", "lot": "4711", "humidity": null}})"));
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(plan->sample.metadata, (record::Metadata{{"temperature", "23 degC"}, {"lot", "4711"}}));
  EXPECT_EQ(plan_of(plan_json(*plan)).value(), *plan);
  for (const auto& [text, why] :
       {std::pair{R"({"facts": ["lot"]})", "facts: must be an object of texts"},
        {R"({"facts": {"temperature": 23}})", "facts: temperature: must be text"},
        {R"({"facts": {"temperature": "23"}})", "facts: temperature: \"23\": a temperature needs its unit"},
        {R"({"facts": {"a b": "x"}})", "facts: key \"a b\""}}) {
    EXPECT_THAT(plan_of(Json::parse(text)).error().message, HasSubstr(why)) << text;
  }
  EXPECT_EQ(facts_in(R"({"lot": "4711", "room": null})").value(),
            (std::map<std::string, std::string>{{"lot", "4711"}, {"room", ""}}));
  EXPECT_THAT(facts_in("23 degC").error().message, HasSubstr("must be JSON"));
  const auto batch = batch_plan_of(Json::parse(R"({"name": "liner", "facts": {"lot": "4711"}})"));
  ASSERT_TRUE(batch) << batch.error().message;
  EXPECT_EQ(batch->sample.metadata.at("lot"), "4711");
  EXPECT_EQ(batch_plan_of(batch_plan_json(*batch)).value(), *batch);
}

TEST(QuantityJson, IsRefusedWithTheSpellingThatIsTaken) {
  EXPECT_EQ(mass_at(R"({"mass": 500})", BareNumber::kOnlyZero).error().message,
            R"(mass: "500": a mass needs its unit, such as "500 g" or "500 kg"; or a number as "mass_kg")");
  EXPECT_EQ(mass_at(R"({"mass": "500"})", BareNumber::kSiWithWarning).error().message,
            R"(mass: "500": a mass needs its unit, such as "500 g" or "500 kg")");
  EXPECT_THAT(mass_at(R"({"mass": "1 g", "mass_kg": 1})", BareNumber::kRefused).error().message,
              HasSubstr("mass and mass_kg: give one"));
  EXPECT_THAT(mass_at(R"({"mass_kg": "1 g"})", BareNumber::kRefused).error().message,
              HasSubstr(R"(mass_kg: must be a number; text with a unit stands under "mass")"));
  EXPECT_THAT(mass_at(R"({"mass": true})", BareNumber::kSi).error().message,
              HasSubstr(R"(must be text with a unit such as "1 kg")"));
}

TEST(QuantityJson, WarnsOfANumberThatTheNextVersionRefuses) {
  Warnings warnings;
  EXPECT_EQ(mass_at(R"({"mass": 2.5})", BareNumber::kSiWithWarning, &warnings).value(), 2.5);
  EXPECT_THAT(warnings,
              ElementsAre(HasSubstr(R"(mass: "2.5": a mass needs its unit; it is read as "2.5 kg")")));
  warnings.clear();
  EXPECT_EQ(mass_at(R"({"mass_kg": 2.5})", BareNumber::kSiWithWarning, &warnings).value(), 2.5);
  EXPECT_THAT(warnings, IsEmpty());
}

TEST(QuantityJson, WarnsOncePerKeyInAHeaderThatParsersTake) {
  Json batch = Json::parse(R"({"name": "a"})");
  for (int i = 1; i <= 100; ++i) batch["pull_speeds"].push_back(0.001 * i);
  Warnings warnings;
  ASSERT_TRUE(batch_plan_of(batch, &warnings));
  EXPECT_THAT(warnings, ElementsAre(HasSubstr(R"(pull_speeds: "0.001")")));
  EXPECT_EQ(text_of(warnings), warnings.front());
  const std::string text = text_of(Warnings(100, std::string(130, 'w')));
  EXPECT_LT(text.size(), 2100U);
  EXPECT_THAT(text, EndsWith("w; and 85 more"));
}

TEST(QuantityJson, WeightOfACalibrationNeedsItsUnitUnlessNothingHangs) {
  EXPECT_EQ(mass_of(Json::parse(R"({"mass": 0})")).value(), 0.0);
  EXPECT_EQ(mass_of(Json::parse(R"({"mass": "0"})")).value(), 0.0);
  EXPECT_EQ(mass_of(Json::parse(R"({"mass": "500 g"})")).value(), 0.5);
  EXPECT_THAT(mass_of(Json::parse(R"({"mass": 0.5})")).error().message, HasSubstr(R"("0.5 g" or "0.5 kg")"));
  EXPECT_THAT(mass_of(Json::parse(R"({"mass": "500"})")).error().message,
              HasSubstr(R"("500 g" or "500 kg")"));
}

TEST(QuantityJson, PlanTakesASpeedInEachSpelling) {
  for (const char* text : {R"({"pull_speed": "6 mm/s"})", R"({"pull_speed_m_per_s": 0.006})"}) {
    Warnings warnings;
    EXPECT_EQ(plan_of(Json::parse(text), &warnings).value().pull_speed_m_per_s, 0.006);
    EXPECT_THAT(warnings, IsEmpty());
  }
  Warnings warnings;
  EXPECT_EQ(plan_of(Json::parse(R"({"pull_speed": 0.006})"), &warnings).value().pull_speed_m_per_s, 0.006);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr(R"("0.006 m/s")")));
}

}  // namespace
}  // namespace stickslip::daemon

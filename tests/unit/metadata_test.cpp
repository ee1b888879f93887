// Free facts of a record: which keys and values are accepted, and what the refusals say.

#include "core/record/metadata.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>

namespace stickslip::record {
namespace {

using ::testing::HasSubstr;

std::string refusal_of(Metadata metadata, const std::string& pair) {
  const auto added = add_metadata(metadata, pair, "--set-meta");
  return added ? std::string{} : added.error().message;
}

TEST(Metadata, TakesAnyValueUnderAPlainKey) {
  Metadata metadata;
  EXPECT_TRUE(add_metadata(metadata, "room.temperature=23.1 °C = ok", "--set-meta"));
  EXPECT_TRUE(add_metadata(metadata, "Lab_2-a=γ", "--set-meta"));
  EXPECT_EQ(metadata, (Metadata{{"Lab_2-a", "γ"}, {"room.temperature", "23.1 °C = ok"}}));
}

TEST(Metadata, RefusesWhatNoFileShouldHold) {
  EXPECT_THAT(refusal_of({}, "note"), HasSubstr("has no '='"));
  for (const char* pair : {"=x", "1a=x", "a/b=x", ".=x", "é=x", "a b=x"})
    EXPECT_THAT(refusal_of({}, pair), HasSubstr("a letter, then letters")) << pair;
  EXPECT_EQ(refusal_of({}, std::string(kLongestMetadataKey, 'k') + "=x"), "");
  EXPECT_THAT(refusal_of({}, std::string(kLongestMetadataKey + 1, 'k') + "=x"), HasSubstr("at most 64"));
  EXPECT_THAT(refusal_of({}, "a="), HasSubstr("a: the value is empty"));
  EXPECT_THAT(refusal_of({}, "a=\xff"), HasSubstr("no text in UTF-8"));
  EXPECT_THAT(refusal_of({}, "a=\x1b[2K"), HasSubstr("control character"));
}

TEST(Metadata, RefusesAKeyTwiceAndTooManyKeys) {
  EXPECT_THAT(refusal_of({{"a", "1"}}, "a=2"), HasSubstr("a is \"1\" already, and \"2\" comes too"));
  Metadata many;
  for (std::size_t i = 0; i < kMostMetadata; ++i) many.emplace(fmt::format("k{}", i), "x");
  EXPECT_THAT(refusal_of(many, "one.more=x"), HasSubstr("at most 100 are allowed"));
}

TEST(Facts, OfAKnownKeyAreCheckedWhereTheyAreStated) {
  const auto refusal = [](const char* key, const char* value) {
    Metadata facts;
    const auto set = set_fact(facts, key, value);
    return set ? std::string{} : set.error().message;
  };
  EXPECT_EQ(refusal("temperature", "23 degC"), "");
  EXPECT_EQ(refusal("temperature", "-80 °C"), "");
  EXPECT_THAT(refusal("temperature", "-81 °C"),
              HasSubstr("not within -80 … 200 degC; write it like \"23 degC\""));
  EXPECT_THAT(refusal("temperature", "23"), HasSubstr("a temperature needs its unit"));
  EXPECT_THAT(refusal("temperature", "warm"), HasSubstr("write a number and one of: degC, K, degF"));
  EXPECT_EQ(refusal("humidity", "100 %"), "");
  EXPECT_EQ(refusal("humidity", "0.5"), "");
  // A percentage without its sign would be fifty times too large.
  EXPECT_THAT(refusal("humidity", "50"), HasSubstr("not within 0 … 1; write it like \"50 %\""));
  EXPECT_EQ(refusal("contact_time", "2 min"), "");
  EXPECT_THAT(refusal("contact_time", "-1 s"), HasSubstr("not within"));
  EXPECT_EQ(refusal("lot", "47 11/b"), "");
  EXPECT_EQ(refusal("conditioning", "ISO 187, 24 h"), "");
  EXPECT_EQ(refusal("room.temperature", "warm"), "");
  for (const KnownFact& fact : known_facts()) {
    if (fact.unit.empty()) continue;
    EXPECT_EQ(refusal(std::string{fact.key}.c_str(), std::string{fact.example}.c_str()), "");
  }
}

TEST(Facts, HaveANumberInTheUnitOfTheRecord) {
  EXPECT_EQ(fact_number("temperature", "23.1 degC").value(), 23.1);
  EXPECT_NEAR(fact_number("temperature", "73.4 degF").value(), 23.0, 1e-9);
  EXPECT_DOUBLE_EQ(fact_number("humidity", "52 %").value(), 0.52);
  EXPECT_DOUBLE_EQ(fact_number("contact_time", "2 min").value(), 120.0);
  EXPECT_FALSE(fact_number("humidity", "dry"));
  // As an older version took it for 52 %.
  EXPECT_FALSE(fact_number("humidity", "52"));
  EXPECT_NE(why_no_number("humidity", "52"), "");
  EXPECT_EQ(why_no_number("humidity", "52 %"), "");
  EXPECT_EQ(why_no_number("lot", "dry"), "");
  EXPECT_FALSE(fact_number("lot", "4711"));
  EXPECT_FALSE(fact_number("room.temperature", "23 degC"));
}

TEST(Facts, AreReplacedAndRemoved) {
  Metadata facts{{"lot", "1"}};
  EXPECT_TRUE(set_fact(facts, "lot", "2"));
  EXPECT_EQ(facts, (Metadata{{"lot", "2"}}));
  EXPECT_TRUE(set_fact(facts, "lot", ""));
  EXPECT_TRUE(set_fact(facts, "never.there", ""));
  EXPECT_EQ(facts, Metadata{});
  EXPECT_EQ(split_fact(" lot = 4=7 ").value(), (std::pair<std::string, std::string>{"lot", "4=7"}));
}

TEST(Facts, OfTwoSourcesAreMergedWithinTheLimitOfARecord) {
  EXPECT_EQ(merged({{"a", "1"}, {"b", "1"}}, {{"b", "2"}, {"c", "2"}}),
            (Metadata{{"a", "1"}, {"b", "2"}, {"c", "2"}}));
  Metadata below;
  Metadata above;
  for (std::size_t i = 0; i < kMostMetadata; ++i) {
    below.emplace(fmt::format("b{}", i), "x");
    above.emplace(fmt::format("a{}", i), "x");
  }
  EXPECT_EQ(merged(below, above), above);
  EXPECT_TRUE(set_fact(above, "a0", "y"));
  EXPECT_FALSE(set_fact(above, "one.more", "y"));
}

}  // namespace
}  // namespace stickslip::record

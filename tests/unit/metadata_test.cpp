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

}  // namespace
}  // namespace stickslip::record

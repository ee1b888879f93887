#include "io/new_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "daemon/control/token.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::io {
namespace {

std::string text_in(const std::filesystem::path& file) {
  std::ifstream in{file};
  return {std::istreambuf_iterator<char>{in}, {}};
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator{folder})
    names.push_back(entry.path().filename().string());
  return names;
}

TEST(NewFile, IsWholeAndAlone) {
  const test::TemporaryFolder folder;
  const std::string text(1'000'000, 'x');
  ASSERT_TRUE(write_new_file(folder / "a.csv", text));
  EXPECT_EQ(text_in(folder / "a.csv"), text);
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("a.csv"));
}

// Somebody else who may write to the folder lays links where the file is built, or where it is to be.
TEST(NewFile, FollowsNoLinkThatLiesInTheFolder) {
  const test::TemporaryFolder folder;
  std::ofstream{folder / "precious"} << "mine";
  for (const char* link : {"a.csv.part", "a.csv.tmp", "b.csv"})
    std::filesystem::create_symlink("precious", folder / link);
  ASSERT_TRUE(write_new_file(folder / "a.csv", "new"));
  EXPECT_EQ(text_in(folder / "a.csv"), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "a.csv"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "a.csv.part")) << "it is nobody's left-over";
  const auto refused = write_new_file(folder / "b.csv", "new");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, base::ErrorKind::kUsage);
  EXPECT_EQ(text_in(folder / "precious"), "mine");
  EXPECT_EQ(names_in(folder.path()).size(), 5U);
}

TEST(NewFile, LeavesNothingWhereItIsRefused) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(write_new_file(folder / "none" / "a.csv", "new"));
  std::ofstream{folder / "a.csv"} << "old";
  EXPECT_FALSE(write_new_file(folder / "a.csv", "new"));
  EXPECT_EQ(text_in(folder / "a.csv"), "old");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("a.csv"));
}

TEST(NewFile, ATokenIsForOwnerAndGroupAndFollowsNoLink) {
  const test::TemporaryFolder folder;
  std::ofstream{folder / "precious"} << "mine";
  std::filesystem::create_symlink("precious", folder / "token.part");
  std::filesystem::create_symlink("nowhere", folder / "dangling");
  const auto token = control::load_token(folder / "token");
  ASSERT_TRUE(token) << token.error().message;
  EXPECT_EQ(text_in(folder / "token"), *token + "\n");
  struct stat facts {};
  ASSERT_EQ(::stat((folder / "token").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777U & ~0640U, 0U);
  EXPECT_FALSE(control::load_token(folder / "dangling"));
  EXPECT_FALSE(std::filesystem::exists(folder / "nowhere"));
  EXPECT_EQ(text_in(folder / "precious"), "mine");
}

}  // namespace
}  // namespace stickslip::io

#include "daemon/storage/folder_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "tests/support/lacking_disk.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::storage {
namespace {

TEST(FolderLock, IsOneProcessesUntilItEndsAndTellsWhose) {
  const test::TemporaryFolder folder;
  {
    const auto first = FolderLock::take(folder.path());
    ASSERT_TRUE(first) << first.error().message;
    // By another name too.
    std::filesystem::create_directory_symlink(folder.path(), folder / "again");
    const auto second = FolderLock::take(folder / "again");
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, base::ErrorKind::kFailure);
    EXPECT_THAT(second.error().message, testing::AllOf(testing::HasSubstr((folder / "again").string()),
                                                       testing::HasSubstr("another stickslipd"),
                                                       testing::HasSubstr("[record] folder")));
    std::filesystem::remove(folder / "again");
  }
  EXPECT_TRUE(FolderLock::take(folder.path()));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "no file is left";
}

// NFS without a lock manager, some FUSE: everybody has it, and nobody is refused.
TEST(FolderLock, WhereThereAreNoLocksEverybodyHasIt) {
  const test::TemporaryFolder folder;
  test::LackingDisk disk;
  for (const int error : {ENOLCK, ENOSYS, EOPNOTSUPP}) {
    disk.flock_error = error;
    const auto first = FolderLock::take(folder.path(), disk);
    EXPECT_TRUE(first) << first.error().message;
    const auto second = FolderLock::take(folder.path(), disk);
    EXPECT_TRUE(second) << second.error().message;
  }
}

TEST(FolderLock, WhereThereIsNoFolderItSaysSo) {
  const auto lock = FolderLock::take("/nonexistent");
  ASSERT_FALSE(lock);
  EXPECT_THAT(lock.error().message, testing::HasSubstr("No such file"));
}

}  // namespace
}  // namespace stickslip::storage

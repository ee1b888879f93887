// The folder of the records at the daemon's start: made, tried, and what it lacks told.

#include <gmock/gmock.h>

#include <cerrno>
#include <filesystem>

#include "daemon/runtime/session_setup.hpp"
#include "tests/support/lacking_disk.hpp"

namespace stickslip::runtime {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(RecordFolder, IsMadeAndTriedAndNothingIsLeft) {
  const test::TemporaryFolder folder;
  const auto lacks = prepare_record_folder(folder / "a" / "records");
  ASSERT_TRUE(lacks) << lacks.error().message;
  EXPECT_THAT(lacks->lacks, IsEmpty());
  EXPECT_TRUE(std::filesystem::is_empty(folder / "a" / "records"));
}

TEST(RecordFolder, OfALackingFileSystemIsUsedAndSaysWhatFollows) {
  const test::TemporaryFolder folder;
  test::LackingDisk disk;
  disk.flock_error = ENOLCK;
  disk.folder_fsync_error = EINVAL;
  const auto lacks = prepare_record_folder(folder / "records", disk);
  ASSERT_TRUE(lacks) << lacks.error().message;
  EXPECT_THAT(lacks->lacks, ElementsAre(HasSubstr("records: the file system has no locks"),
                                        HasSubstr("records: the file system cannot sync folders")));
}

TEST(RecordFolder, InWhichNothingCanBeMadeIsRefusedByName) {
  const test::TemporaryFolder folder;
  test::LackingDisk disk;
  disk.create_error = EROFS;
  const auto refused = prepare_record_folder(folder / "records", disk);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("records: cannot be written: Read-only file system"));
}

}  // namespace
}  // namespace stickslip::runtime

#include "daemon/recovery.hpp"

#include <gmock/gmock.h>

#include "core/record/finaliser.hpp"
#include "core/record/journal_care.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/journal_samples.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::daemon {
namespace {

using record::judge;
using record::Judgement;
using test::TemporaryFolder;
using testing::HasSubstr;
namespace fs = std::filesystem;

class Heard final : public Facts {
 public:
  void orphan_finalised(const fs::path& file) override { text += "made " + file.filename().string() + "\n"; }
  void orphan_empty(const fs::path& journal) override {
    text += "removed " + journal.filename().string() + "\n";
  }
  void orphan_kept(const fs::path& journal, std::string_view why) override {
    text += fmt::format("kept {}: {}\n", journal.filename().string(), why);
  }
  std::string text;
};

base::Result<fs::path> finalise_plainly(const fs::path& journal) { return record::finalise(journal); }

TEST(Recovery, MakesRecordsRemovesWhatIsEmptyAndKeepsTheRest) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "2026/11");
  test::write_journal(folder / "a.journal", test::whole_record(), false);
  test::write_journal(folder / "2026/11/b.journal", test::whole_record());
  const std::string header = test::content_of(folder / "a.journal").substr(0, 40);
  test::write_content(folder / "c.journal", "");
  test::write_content(folder / "d.journal", header);
  test::write_content(folder / "e.journal", std::string(300, '\0'));
  test::write_content(folder / "f.journal", "a stranger's diary");
  Heard heard;
  EXPECT_FALSE(recover_folder(folder.path(), finalise_plainly, heard));

  EXPECT_EQ(heard.text.substr(0, heard.text.find("kept f")),
            "made b.h5\nmade a.h5\nremoved c.journal\nremoved d.journal\nremoved e.journal\n");
  EXPECT_THAT(heard.text, HasSubstr("kept f.journal"));
  EXPECT_TRUE(fs::exists(folder / "f.journal"));
  EXPECT_FALSE(fs::exists(folder / "e.journal"));
  EXPECT_EQ(judge(folder / "2026/11/b.h5").judgement, Judgement::kComplete);
  EXPECT_EQ(judge(folder / "a.h5").status, "interrupted");
}

TEST(Recovery, NobodyTouchesAJournalThatIsBeingWritten) {
  const TemporaryFolder folder;
  const auto writing = record::JournalWriter::create(folder / "a.journal", test::sample_header());
  ASSERT_TRUE(writing);
  for (const auto& error : {finalise_plainly(folder / "a.journal").error(),
                            record::remove_if_empty(folder / "a.journal").error()}) {
    EXPECT_THAT(error.message, HasSubstr("is being written or finished by another process"));
  }
  EXPECT_TRUE(fs::exists(folder / "a.journal"));
}

// A header that was changed by the disk is no empty journal: what follows it is worth more than its removal.
TEST(Recovery, AJournalWithADamagedHeaderIsKept) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::whole_record());
  std::string content = test::content_of(folder / "a.journal");
  content[50] = static_cast<char>(content[50] ^ 4);
  test::write_content(folder / "a.journal", content);
  Heard heard;
  EXPECT_FALSE(recover_folder(folder.path(), finalise_plainly, heard));
  EXPECT_TRUE(fs::exists(folder / "a.journal"));
}

}  // namespace
}  // namespace stickslip::daemon

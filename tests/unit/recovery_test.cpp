#include "daemon/storage/recovery.hpp"

#include <gmock/gmock.h>

#include "core/record/finaliser.hpp"
#include "core/record/journal_care.hpp"
#include "core/record/verdict.hpp"
#include "daemon/storage/finaliser_process.hpp"
#include "tests/support/closed_folder.hpp"
#include "tests/support/journal_samples.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::storage {
namespace {

using record::judge;
using record::Judgement;
using test::ClosedFolder;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

class Heard final : public daemon::EventReceiver {
 public:
  void orphan_finalised(const fs::path& file) override { text += "made " + file.filename().string() + "\n"; }
  void record_damaged(const fs::path& file, std::string_view loss) override {
    text += fmt::format("damaged {}: {}\n", file.filename().string(), loss);
  }
  void orphan_empty(const fs::path& journal) override {
    text += "removed " + journal.filename().string() + "\n";
  }
  void orphan_kept(const fs::path& journal, std::string_view why) override {
    text += fmt::format("kept {}: {}\n", journal.filename().string(), why);
  }
  void folder_unread(const fs::path& folder, std::string_view why) override {
    text += fmt::format("unread {}: {}\n", folder.filename().string(), why);
  }
  std::string text;
};

base::Result<record::Finalised> finalise_plainly(const fs::path& journal, ExpectedScans) {
  return record::finalise(journal);
}

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
  EXPECT_EQ(recover_folder(folder.path(), finalise_plainly, heard), Recovery::kRefused);

  EXPECT_EQ(heard.text.substr(0, heard.text.find("kept f")),
            "made b.h5\nmade a.h5\nremoved c.journal\nremoved d.journal\nremoved e.journal\n");
  EXPECT_THAT(heard.text, HasSubstr("kept f.journal"));
  EXPECT_TRUE(fs::exists(folder / "f.journal"));
  EXPECT_FALSE(fs::exists(folder / "e.journal"));
  EXPECT_EQ(judge(folder / "2026/11/b.h5").judgement, Judgement::kComplete);
  EXPECT_EQ(judge(folder / "a.h5").status, "interrupted");
}

// The folder of one month is closed: the others' journals become records, and it is told.
TEST(Recovery, AClosedFolderIsToldAndHidesNoOther) {
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::all);  // Whoever the test becomes.
  for (const char* month : {"2026/09", "2026/10", "2026/11"}) {
    fs::create_directories(folder / month);
    fs::permissions(folder / month, fs::perms::all);
    test::write_journal(folder / month / "a.journal", test::whole_record());
    fs::permissions(folder / month / "a.journal", fs::perms::all);
  }
  Heard heard;
  {
    const ClosedFolder closed{folder / "2026/10"};
    EXPECT_EQ(recover_folder(folder.path(), finalise_plainly, heard), Recovery::kRefused);
  }
  EXPECT_EQ(heard.text, "made a.h5\nmade a.h5\nunread 10: Permission denied\n");
  EXPECT_TRUE(fs::exists(folder / "2026/09/a.h5"));
  EXPECT_TRUE(fs::exists(folder / "2026/11/a.h5"));
  EXPECT_TRUE(fs::exists(folder / "2026/10/a.journal"));
}

TEST(Recovery, LooksWhereRecordsAreMade) {
  const TemporaryFolder folder;
  const TemporaryFolder elsewhere;
  for (const char* below : {"2026/11", "2026-11-21", "2026/11/deeper", "lost+found"}) {
    fs::create_directories(folder / below);
    test::write_content(folder / below / "a.journal", "");
  }
  test::write_content(elsewhere / "a.journal", "");
  fs::create_directory_symlink(elsewhere.path(), folder / "link");
  const io::FilesFound found = journals_in(folder.path());
  EXPECT_THAT(found.files, ElementsAre(folder / "2026-11-21/a.journal", folder / "2026/11/a.journal"));
  EXPECT_TRUE(found.unread.empty());
  EXPECT_TRUE(journals_in(folder / "nowhere").unread.empty());
}

// Two finalisers of one journal: the second says what the first one's record holds, not what it hoped for.
TEST(Finaliser, CountsTheScansOfARecordThatSomebodyElseMade) {
  const TemporaryFolder folder;
  test::write_journal(folder / "a.journal", test::whole_record());
  ASSERT_TRUE(record::finalise(folder / "a.journal"));
  const auto again = finalise_here(folder / "a.journal");
  ASSERT_TRUE(again) << again.error().message;
  const std::int64_t held = static_cast<std::int64_t>(test::whole_record().scan.size());
  EXPECT_EQ(again->scan_count, held);
  EXPECT_EQ(loss_of(*again, held + 45),
            fmt::format("45 of {} scans were written and cannot be read", held + 45));
  test::write_content(folder / "a.h5", "no record");
  EXPECT_FALSE(finalise_here(folder / "a.journal")) << "something stands there, but no record";
}

TEST(Finaliser, APathThatCannotBeLookedAtIsNotFinished) {
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::all);
  fs::create_directory(folder / "2026");
  test::write_journal(folder / "2026/a.journal", test::whole_record());
  const ClosedFolder closed{folder / "2026"};
  EXPECT_FALSE(is_finished(folder / "2026/a.journal"));
}

TEST(Recovery, NobodyTouchesAJournalThatIsBeingWritten) {
  const TemporaryFolder folder;
  const auto writing = record::JournalWriter::create(folder / "a.journal", test::sample_header());
  ASSERT_TRUE(writing);
  for (const auto& error : {finalise_plainly(folder / "a.journal", {}).error(),
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
  EXPECT_EQ(recover_folder(folder.path(), finalise_plainly, heard), Recovery::kRefused);
  EXPECT_TRUE(fs::exists(folder / "a.journal"));
  EXPECT_THAT(heard.text, HasSubstr("its header, at byte 0, is damaged"));
}

TEST(Recovery, ADamagedJournalIsToldOnceAndStays) {
  const TemporaryFolder folder;
  const auto sizes = test::write_journal(folder / "a.journal", test::whole_record());
  std::string content = test::content_of(folder / "a.journal");
  content[sizes[3] - 1] = static_cast<char>(content[sizes[3] - 1] ^ 4);
  test::write_content(folder / "a.journal", content);
  Heard heard;
  EXPECT_EQ(recover_folder(folder.path(), finalise_plainly, heard), Recovery::kDamaged);
  EXPECT_EQ(heard.text,
            fmt::format("made a.h5\ndamaged a.h5: {} bytes of its journal could not be read; the journal "
                        "is kept: {}\n",
                        sizes[3] - sizes[2], (folder / "a.journal.damaged").string()));
  EXPECT_EQ(test::content_of(folder / "a.journal.damaged"), content);
  heard.text.clear();
  EXPECT_EQ(recover_folder(folder.path(), finalise_plainly, heard), Recovery::kDone);
  EXPECT_EQ(heard.text, "");
  EXPECT_EQ(judge(folder / "a.journal.damaged").judgement, Judgement::kDamaged);
}

// How many scans were written is known to the daemon alone: a journal that lost its last ones looks whole.
TEST(Finaliser, IsToldTheJournalAndHowManyScansWereWritten) {
  const TemporaryFolder folder;
  const fs::path program = folder / "program";
  test::write_content(program, "#!/bin/sh\necho \"$@\" > \"$2\"\necho '250 0 '\n");
  fs::permissions(program, fs::perms::owner_all);
  const fs::path journal = folder / "a.journal";
  const auto made = run_finaliser(program, journal, 295);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->scan_count, 250);
  EXPECT_EQ(test::content_of(journal), fmt::format("--finalise {} --scans 295\n", journal.string()));
  ASSERT_TRUE(run_finaliser(program, journal, {}));
  EXPECT_EQ(test::content_of(journal), fmt::format("--finalise {}\n", journal.string())) << "nobody knows";
}

TEST(Finaliser, WhatItSaysOfWhatItMadeIsReadAgain) {
  for (const record::Finalised& made : {record::Finalised{"r/a.h5", 295, 0, {}},
                                        record::Finalised{"r/a.h5", 250, 122, "r/a b.journal.damaged"}}) {
    const auto again = finalised_from_text("r/a.journal", to_text(made));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->file, made.file);
    EXPECT_EQ(again->scan_count, made.scan_count);
    EXPECT_EQ(again->damaged_size, made.damaged_size);
    EXPECT_EQ(again->kept, made.kept);
  }
  for (const char* text : {"", "295", "295 ", "made", "295 many x"}) {
    EXPECT_FALSE(finalised_from_text("r/a.journal", text)) << text;
  }
  EXPECT_EQ(loss_of({"r/a.h5", 295, 0, {}}, 295), "");
  EXPECT_EQ(loss_of({"r/a.h5", 250, 0, {}}, 295), "45 of 295 scans were written and cannot be read");
}

}  // namespace
}  // namespace stickslip::storage

// A flipped bit anywhere in a record is found.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "core/base/limited_child.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/bit_flips.hpp"
#include "tests/support/record_samples.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip {
namespace {

using record::Finding;
using record::Judgement;
using record::Verdict;

const std::vector<std::string> kRaw{"counts", "scan", "time", "force", "flags"};

/// A sound record with noise in it, made once.
class SoundRecord {
 public:
  SoundRecord() {
    record::Record record = test::sample_record();
    record.scan.clear();
    record.raw.clear();
    record.second.clear();
    record.header.board.second.reset();
    record.true_coefficient.clear();
    record.spikes.clear();
    record.gaps = {{1020, 20, true, daq::GapCause::kOverrun}};
    // A linear congruential generator [Knuth, TAOCP 2, 3.3.4, table 1, line 26].
    std::uint64_t state = 1;
    for (std::int64_t i = 0; i < kScans; ++i) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      record.scan.push_back(i < 20 ? 1000 + i : 1020 + i);
      record.raw.push_back(30000.0 + 500.0 * std::sin(0.01 * static_cast<double>(i)) +
                           static_cast<double>(state >> 60U));
      record.raw.back() = std::floor(record.raw.back());
    }
    record.anchors = {{1000, 5'000'000'000, 1'795'265'582'000'000'000},
                      {1059, 5'168'000'000, 1'795'265'582'168'000'000}};
    record.end->status = record::Status::kComplete;
    record.end->reasons.clear();
    EXPECT_TRUE(record::publish_record(record, path()));
    content = test::content_of(path());
    chunks = test::chunks_of(path(), "/entry/raw", kRaw);
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "sound.h5"; }
  [[nodiscard]] std::filesystem::path flipped() const { return folder_ / "flipped.h5"; }

  std::string content;
  std::vector<test::Extent> chunks;

 private:
  static constexpr std::int64_t kScans = 2'000;
  test::TemporaryFolder folder_;
};

const SoundRecord& sound_record() {
  static const SoundRecord sound;
  return sound;
}

bool names(const Verdict& verdict, const std::string& place) {
  return std::any_of(verdict.findings.begin(), verdict.findings.end(), [&](const Finding& finding) {
    return finding.weight == Finding::Weight::kDamage && finding.place.find(place) == 0;
  });
}

TEST(RecordFlips, TheRecordIsSoundBefore) {
  const Verdict verdict = record::judge(sound_record().path());
  // Incomplete for its gap alone.
  ASSERT_EQ(verdict.findings.size(), 1U) << verdict.findings.back().place << verdict.findings.back().text;
  EXPECT_EQ(verdict.findings.front().place, "gaps");
  EXPECT_EQ(verdict.scans_present, verdict.scans_committed);
  EXPECT_EQ(sound_record().chunks.size(), kRaw.size());
}

/// Printed, so that a failure can be had again with STICKSLIP_SEED.
std::mt19937_64 seeded() {
  const char* const given = std::getenv("STICKSLIP_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::printf("STICKSLIP_SEED=%llu\n", static_cast<unsigned long long>(seed));
  return std::mt19937_64{seed};
}

constexpr int kFlips = test::kSanitized ? 10 : 100;

std::uint64_t below(std::mt19937_64& random, std::uint64_t end) {
  return std::uniform_int_distribution<std::uint64_t>{0, end - 1}(random);
}

TEST(RecordFlips, InTheRawDataAreFoundAndPlaced) {
  std::mt19937_64 random = seeded();
  for (int flip = 0; flip < kFlips; ++flip) {
    const test::Extent chunk = sound_record().chunks[below(random, sound_record().chunks.size())];
    const std::uint64_t bit = 8 * chunk.first + below(random, 8 * chunk.size);
    test::write_flipped(sound_record().flipped(), sound_record().content, bit);

    const Verdict verdict = record::judge(sound_record().flipped());

    ASSERT_EQ(verdict.judgement, Judgement::kDamaged) << "bit " << bit;
    ASSERT_TRUE(names(verdict, "entry/raw/" + chunk.dataset + " rows ")) << "bit " << bit;
    // The checksum of the whole file finds it too.
    ASSERT_TRUE(names(verdict, "file")) << "bit " << bit;
  }
}

/// In a child: a reader that does not come back has found it as well.
bool found(std::uint64_t bit) {
  constexpr base::WorkLimits kLimits{std::chrono::seconds{60}, 512'000'000};
  static base::LimitedChild reader{base::ChildWork{[](std::string_view file, int /*memory_file*/) {
    const Judgement judgement = record::judge(file).judgement;
    return std::string{judgement == Judgement::kDamaged || judgement == Judgement::kNotJudged ? "y" : "n"};
  }}};
  test::write_flipped(sound_record().flipped(), sound_record().content, bit);
  const auto answer = reader.ask(sound_record().flipped().native(), kLimits);
  return answer ? *answer == "y" : answer.error().kind == base::ErrorKind::kUsage;
}

// Also where HDF5 has no checksum: results, indices of chunks, bytes that nobody uses.
TEST(RecordFlips, AnywhereElseAreFound) {
  std::mt19937_64 random = seeded();
  for (int flip = 0; flip < kFlips; ++flip) {
    const std::uint64_t bit = below(random, 8 * sound_record().content.size());
    ASSERT_TRUE(found(bit)) << "bit " << bit;
  }
}

// With STICKSLIP_EVERY_BIT=N: every N-th bit of the file; figures in docs/reliability-evidence.md.
TEST(RecordFlips, EveryBitIsFound) {
  const char* const stride = std::getenv("STICKSLIP_EVERY_BIT");
  if (stride == nullptr) GTEST_SKIP() << "takes long: set STICKSLIP_EVERY_BIT=1 for every bit";
  std::uint64_t tried = 0;
  for (std::uint64_t bit = 0; bit < 8 * sound_record().content.size();
       bit += std::strtoull(stride, nullptr, 10)) {
    ASSERT_TRUE(found(bit)) << "bit " << bit;
    ++tried;
  }
  std::printf("%llu of %zu bits flipped, each found\n", static_cast<unsigned long long>(tried),
              8 * sound_record().content.size());
}

}  // namespace
}  // namespace stickslip

// process/estimator: written as a field of its own, read from there, and, of records of version 0.1, from the
// text of the method.

#include "core/record/estimator_field.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "io/config.hpp"

#include "core/record/json_codec.hpp"
#include "core/record/method_text.hpp"
#include "daemon/runtime/session_setup.hpp"

namespace stickslip {
namespace {

using detect::EstimatorTier;
using record::ProcessFacts;

/// (method, estimator), as a record has them.
ProcessFacts facts(std::string method, std::string estimator) {
  ProcessFacts process;
  process.method = std::move(method);
  process.estimator = std::move(estimator);
  return process;
}

TEST(EstimatorField, IsAWordAndTheFitWhereItIsEmpty) {
  EXPECT_EQ(record::estimator_of({}), EstimatorTier::kFit);
  for (const EstimatorTier tier : {EstimatorTier::kTurningPoints, EstimatorTier::kFit}) {
    EXPECT_EQ(record::estimator_of(facts("", std::string{detect::name(tier)})), tier);
  }
  for (const char* former : {"peak", "interpolated"})
    EXPECT_EQ(record::estimator_of(facts("", former)), EstimatorTier::kTurningPoints);
  const auto refused = record::estimator_of(facts("", "closed form"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "process/estimator \"closed form\" is not \"turning-points\" or \"fit\"");
  EXPECT_EQ(refused.error().exit_status(), 2);
}

TEST(EstimatorField, OfVersion01StandsInTheMethod) {
  const auto read = [](ProcessFacts process) {
    record::read_estimator_of_0_1(process);
    return process;
  };
  const std::string plain = "penner-1995 kinetic_cycles=10";
  EXPECT_EQ(read(facts(plain, "")), facts(plain, ""));
  EXPECT_EQ(read(facts(plain + " estimator=peak", "")), facts(plain, "peak"));
  EXPECT_EQ(read(facts("own estimator=interpolated kinetic_cycles=3", "")),
            facts("own kinetic_cycles=3", "interpolated"));
  // A field that is there counts, and a word that is none stays to be refused with its method.
  EXPECT_EQ(read(facts(plain + " estimator=peak", "fit")), facts(plain + " estimator=peak", "fit"));
  EXPECT_EQ(read(facts(plain + " estimator=best", "")), facts(plain + " estimator=best", ""));
  EXPECT_FALSE(record::method_from_text(plain + " estimator=best"));
  // A client that names a method as 0.1 told it is understood.
  EXPECT_EQ(record::method_from_text(plain + " estimator=peak").value(), model::Method{});
}

TEST(EstimatorField, IsReadFromTheJournalOfVersion01) {
  record::RecordHeader header;
  header.process = facts("penner-1995 kinetic_cycles=10 estimator=peak", "");
  const ProcessFacts read = record::header_from_json(record::header_to_json(header)).process;
  EXPECT_EQ(read, facts("penner-1995 kinetic_cycles=10", "peak"));
}

/// Knows what it is, and has no scans.
class SilentBoard final : public daq::Board {
 public:
  SilentBoard() { info_.quantity = daq::RawQuantity::kCoefficient; }
  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return info_; }
  [[nodiscard]] base::Result<void> start() override { return {}; }
  [[nodiscard]] daq::ReadStatus read(daq::ScanBlock&, std::chrono::milliseconds) noexcept override {
    return daq::ReadStatus::kEndOfInput;
  }
  void stop() noexcept override {}

 private:
  daq::BoardInfo info_;
};

/// What a session writes as the process of its records.
ProcessFacts written(const std::string& recorded, std::optional<EstimatorTier> configured) {
  drivers::OpenedBoard opened{std::make_unique<SilentBoard>(), nullptr, {}, {}, {}, nullptr};
  opened.estimator = recorded;
  io::DaemonConfig config;
  config.estimator = configured;
  const auto settings = runtime::session_settings(config, opened, {});
  EXPECT_TRUE(settings);
  if (!settings) return {};
  const record::RecordHeader header = runtime::record_header(config, *settings, opened.board->info(), "");
  EXPECT_EQ(record::estimator_of(header.process), settings->processor.analysis.estimator);
  EXPECT_EQ(header.process.method, "penner-1995 kinetic_cycles=10");
  return header.process;
}

TEST(EstimatorField, IsThatOfTheConfigurationElseOfTheReplayedRecord) {
  EXPECT_EQ(written("", {}).estimator, "fit");
  // A record of version 0.1: its scans are evaluated by what there is now.
  EXPECT_EQ(written("peak", {}).estimator, "turning-points");
  EXPECT_EQ(written("fit", EstimatorTier::kTurningPoints).estimator, "turning-points");
  EXPECT_EQ(written("peak", EstimatorTier::kFit).estimator, "fit");
  EXPECT_EQ(written("closed form", {}).estimator, "fit");
}

}  // namespace
}  // namespace stickslip

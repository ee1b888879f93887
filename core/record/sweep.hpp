/// \file
/// Results of a sweep: a scene run several times at every point of a grid. Runs are numbered from 0 on,
/// repetitions of one point first, the last axis next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/model/truth.hpp"
#include "core/record/fields.hpp"

namespace stickslip::record {

/// One varied key of the scene.
struct SweepAxis {
  std::string key;                 ///< Its dotted path.
  std::string unit;                ///< Of the values, as it was asked for; "1" if there is none.
  std::vector<double> values;      ///< In this unit; for words 0, 1, …
  std::vector<std::string> words;  ///< Texts that the values number; empty for numeric values.

  bool operator==(const SweepAxis&) const = default;
};

/// Request and program version of a sweep: everything that determines its results.
struct SweepFacts {
  std::string version;     ///< Of the program.
  std::string commit;      ///< Of the program.
  std::string command;     ///< Without options that do not affect results: output, threads.
  std::string method;      ///< Preset of the traditional rule.
  std::string scene_name;  ///< Of the file.
  std::string scene_text;  ///< Complete text of the scene at the first point.
  std::uint64_t seed = 0;  ///< Base seed; each run's seed follows from it and the run's number.
  std::vector<SweepAxis> axes;
  std::int64_t repeat = 1;  ///< Runs at each point; at least 1.

  [[nodiscard]] std::int64_t point_count() const noexcept;
  [[nodiscard]] std::int64_t run_count() const noexcept { return point_count() * repeat; }
  /// Index along each axis.
  [[nodiscard]] std::vector<std::size_t> indices_of(std::int64_t point) const;
};

/// One run; its truth has no lists and texts.
struct SweepRun {
  std::int64_t number = 0;
  analysis::TestResults results;
  model::TestTruth truth;
  std::int64_t true_cycle_count = 0;  ///< Number of true slips, including those after the pull.
};

/// The runs by columns: about 700 bytes each.
class SweepTable {
 public:
  struct Result {
    analysis::ResultName name;
    std::vector<double> value;                   ///< NaN where there is none.
    std::vector<double> standard_error;          ///< NaN where there is none.
    std::vector<double> systematic_uncertainty;  ///< NaN where there is none.
    std::vector<std::uint32_t> reason;           ///< Why there is no value: index of reasons().
  };
  struct Truth {
    FieldName name;
    std::vector<double> value;  ///< NaN where there is none.
  };

  explicit SweepTable(std::int64_t run_count);

  /// \param run  with a number below run_count.
  void set(const SweepRun& run);

  [[nodiscard]] std::size_t run_count() const noexcept { return regime_.size(); }
  [[nodiscard]] const std::vector<Result>& results() const noexcept { return results_; }
  [[nodiscard]] const std::vector<Truth>& truths() const noexcept { return truths_; }
  /// \param name must be that of a result or truth.
  [[nodiscard]] const Result& result(std::string_view name) const;
  [[nodiscard]] const Truth& truth(std::string_view name) const;
  /// Distinct reasons; the first is empty and means that there is a value.
  [[nodiscard]] const std::deque<std::string>& reasons() const noexcept { return reasons_; }
  /// Indices of model::kRegimeNames.
  [[nodiscard]] const std::vector<std::uint8_t>& regime() const noexcept { return regime_; }
  [[nodiscard]] const std::vector<std::uint8_t>& true_regime() const noexcept { return true_regime_; }
  /// Indices of analysis::kRungNames.
  [[nodiscard]] const std::vector<std::uint8_t>& rung() const noexcept { return rung_; }
  [[nodiscard]] const std::vector<std::uint64_t>& seed() const noexcept { return seed_; }

 private:
  [[nodiscard]] std::uint32_t reason_index(const std::string& reason);

  std::vector<Result> results_;
  std::vector<Truth> truths_;
  std::deque<std::string> reasons_{""};
  std::map<std::string, std::uint32_t, std::less<>> reason_index_{{"", 0}};
  std::vector<std::uint8_t> regime_;
  std::vector<std::uint8_t> true_regime_;
  std::vector<std::uint8_t> rung_;
  std::vector<std::uint64_t> seed_;
};

}  // namespace stickslip::record

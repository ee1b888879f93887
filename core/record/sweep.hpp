/// \file
/// What a sweep found, in memory: a scene run at every point of a grid, several times each.
/// Runs are numbered from 0 on, repetitions of one point first, the last axis next.
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
  std::vector<std::string> words;  ///< What the values stand for; empty if they are numbers.

  bool operator==(const SweepAxis&) const = default;
};

/// What was asked for, and by whom it was done: all that decides the numbers.
struct SweepFacts {
  std::string version;     ///< Of the program.
  std::string commit;      ///< Of the program.
  std::string command;     ///< Without what changes no number: output, threads.
  std::string method;      ///< Preset of the traditional rule.
  std::string scene_name;  ///< Of the file.
  std::string scene_text;  ///< The scene of the first point, whole.
  std::uint64_t seed = 0;  ///< From which, and its number, each run has its own.
  std::vector<SweepAxis> axes;
  std::int64_t repeat = 1;  ///< Runs at each point; at least 1.

  [[nodiscard]] std::int64_t point_count() const noexcept;
  [[nodiscard]] std::int64_t run_count() const noexcept { return point_count() * repeat; }
  /// Index along each axis.
  [[nodiscard]] std::vector<std::size_t> indices_of(std::int64_t point) const;
};

/// One run, with its truth but for lists and texts.
struct SweepRun {
  std::int64_t number = 0;
  analysis::TestResults results;
  model::TestTruth truth;
  std::int64_t true_cycle_count = 0;  ///< Slips, those after the pull too.
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
  /// The first is empty: there is a value.
  [[nodiscard]] const std::deque<std::string>& reasons() const noexcept { return reasons_; }
  /// Indices of model::kRegimeNames.
  [[nodiscard]] const std::vector<std::uint8_t>& regime() const noexcept { return regime_; }
  [[nodiscard]] const std::vector<std::uint8_t>& true_regime() const noexcept { return true_regime_; }
  [[nodiscard]] const std::vector<std::uint64_t>& seed() const noexcept { return seed_; }

 private:
  [[nodiscard]] std::uint32_t reason_index(const std::string& reason);

  std::vector<Result> results_;
  std::vector<Truth> truths_;
  std::deque<std::string> reasons_{""};
  std::map<std::string, std::uint32_t, std::less<>> reason_index_{{"", 0}};
  std::vector<std::uint8_t> regime_;
  std::vector<std::uint8_t> true_regime_;
  std::vector<std::uint64_t> seed_;
};

}  // namespace stickslip::record

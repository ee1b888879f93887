/// \file
/// Results of a sweep: a scene run several times at every point of a grid. Runs and points are numbered from
/// 0: run = point · repeat + repetition. From point to point, the value of the last axis changes first.
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
  std::string key;                 ///< Dotted path in the scene.
  std::string unit;                ///< Unit of the values, as the user gave it, need not be SI; "1": none.
  std::vector<double> values;      ///< In `unit`; if the values are texts: 0, 1, …
  std::vector<std::string> words;  ///< The texts, in the order of `values`; empty for numbers.

  bool operator==(const SweepAxis&) const = default;
};

/// Request and program version of a sweep: everything that determines its results.
struct SweepFacts {
  std::string version;     ///< Of the program.
  std::string commit;      ///< Of the program.
  std::string command;     ///< Without options that do not affect results, such as --threads.
  std::string method;      ///< Test method, method_text().
  std::string scene_name;  ///< Name of the scene.
  std::string scene_text;  ///< Complete text of the scene at the first point.
  /// Base seed of the first point. A run's seed follows from its point's base seed and the run's number.
  std::uint64_t seed = 0;
  std::vector<SweepAxis> axes;
  std::int64_t repeat = 1;  ///< Runs at each point; at least 1.

  /// Product of the numbers of values; 1 without axes.
  [[nodiscard]] std::int64_t point_count() const noexcept;
  [[nodiscard]] std::int64_t run_count() const noexcept { return point_count() * repeat; }
  /// Index of the point's value on each axis. \param point  0 … point_count() − 1.
  [[nodiscard]] std::vector<std::size_t> indices_of(std::int64_t point) const;
};

/// One run. Its truth has no modes, no cycles and no scene_text.
struct SweepRun {
  std::int64_t number = 0;
  analysis::TestResults results;
  model::TestTruth truth;
  /// Number of true slips from the first scan that arrived to the end of the scene, also after the pull.
  std::int64_t true_cycle_count = 0;
};

/// The runs by columns, about 1.1 kB for each run. Row i of each column belongs to run i. Until set() is
/// called for a run, its numbers are NaN, its indices and its seed 0.
class SweepTable {
 public:
  /// A result of all runs.
  struct Result {
    analysis::ResultName name;
    std::vector<double> value;                   ///< NaN where there is none.
    std::vector<double> standard_error;          ///< NaN where there is none.
    std::vector<double> systematic_uncertainty;  ///< NaN where there is none.
    std::vector<std::uint32_t> reason;           ///< Why there is no value: index into reasons().
  };
  /// A number of the truth of all runs, also delta_mu (S − K) and cycle_count.
  struct Truth {
    FieldName name;
    std::vector<double> value;  ///< NaN where there is none.
  };

  /// \param run_count  > 0.
  explicit SweepTable(std::int64_t run_count);

  /// Fills the row of a run. \param run  number: 0 … run_count() − 1.
  void set(const SweepRun& run);

  [[nodiscard]] std::size_t run_count() const noexcept { return regime_.size(); }
  [[nodiscard]] const std::vector<Result>& results() const noexcept { return results_; }
  [[nodiscard]] const std::vector<Truth>& truths() const noexcept { return truths_; }
  /// \param name  of a result; for truth() of a truth (contract).
  [[nodiscard]] const Result& result(std::string_view name) const;
  [[nodiscard]] const Truth& truth(std::string_view name) const;
  /// Distinct reasons; the first is empty, for results with a value.
  [[nodiscard]] const std::deque<std::string>& reasons() const noexcept { return reasons_; }
  /// Index into model::kRegimeNames for each run.
  [[nodiscard]] const std::vector<std::uint8_t>& regime() const noexcept { return regime_; }
  [[nodiscard]] const std::vector<std::uint8_t>& true_regime() const noexcept { return true_regime_; }
  /// Index into analysis::kRungNames for each run.
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

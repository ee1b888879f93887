/// \file
/// The seven control charts of a tester, fed test by test.
///
///     TesterCharts charts{"reference 7"};
///     for (const TestValues& test : history) charts.add(test);
///     for (const base::Finding& finding : charts.findings()) …
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/finding.hpp"
#include "core/trend/control_chart.hpp"

namespace stickslip::trend {

/// In the order of chart_kinds(), which has the units. Damping is γ/2ω, spikes are per scan, and the rate is
/// the measured over the granted scan rate, less 1.
enum class Quantity : std::uint8_t { kReference, kOmega, kDamping, kZero, kNoise, kSpikes, kRate };
inline constexpr std::size_t kQuantities = static_cast<std::size_t>(Quantity::kRate) + 1;

struct ChartKind {
  std::string_view name;     ///< Stable between versions: "zero".
  std::string_view unit;     ///< SI, "1" for a ratio or a count.
  std::string_view meaning;  ///< For people; begins a sentence.
  std::string_view key;      ///< Of its value in a line of the tester's history, with the unit; empty: none.
  base::FindingCode code;
};

[[nodiscard]] const std::array<ChartKind, kQuantities>& chart_kinds() noexcept;
[[nodiscard]] const ChartKind& kind_of(Quantity quantity) noexcept;
[[nodiscard]] std::optional<Quantity> quantity_from_name(std::string_view name) noexcept;

/// What one finished test gives to the charts. An absent or not finite value adds no point to its chart.
struct TestValues {
  std::string time;    ///< ISO 8601, when the test began.
  std::string file;    ///< Path relative to the record folder, by which voidings name the test.
  std::string sample;  ///< Name of the sample; empty if unknown.
  std::optional<double> pull_speed_m_per_s;
  std::optional<double> mu_k;
  std::optional<double> delta_mu;
  /// By Quantity, in the units of chart_kinds(); that of kReference is not read: TesterCharts takes delta_mu
  /// or mu_k.
  std::array<std::optional<double>, kQuantities> values;

  bool operator==(const TestValues&) const = default;
};

/// A shift that was told and that nobody has acknowledged.
struct StandingAlarm {
  bool rises = false;
  double shift = 0.0;               ///< In the unit of the chart; an estimate, large when told early.
  double standard_deviation = 0.0;  ///< Of the chart before the change.
  std::string since_time;           ///< Of the first test of the estimated change.
  std::string since_file;
  std::string told_time;  ///< Of the test that told it.
  std::string told_file;
};

enum class Verdict {
  kOff,        ///< No value yet.
  kLearning,   ///< Fewer values than kFullBaseline.
  kInControl,  ///< kFullBaseline values or more.
  kAlarm       ///< An alarm stands, however many values there are.
};
/// "off", "learning", "in control", "alarm".
[[nodiscard]] std::string_view name(Verdict verdict) noexcept;

/// A test on a chart, to draw it.
struct ChartPoint {
  std::string time;
  std::string file;
  double value = 0.0;
  // Arms with this value, in standard deviations. At an alarm the arm that did not tell it is 0.
  double upper = 0.0;
  double lower = 0.0;
};

/// One chart since its first value, or since its latest restart with a new baseline.
struct ChartState {
  ControlChart chart;
  std::optional<double> latest;  ///< Its latest value.
  std::string latest_file;
  std::int64_t outside_count = 0;  ///< Values beyond Shewhart limits.
  std::optional<StandingAlarm> alarm;
  /// Why the latest test gave no value, or that there was none since a new baseline; empty if it gave one,
  /// and before the first test.
  std::string no_value_reason;
  std::deque<ChartPoint> points;  ///< The latest kMostPoints, oldest first.
  static constexpr std::size_t kMostPoints = 200;

  [[nodiscard]] Verdict verdict() const noexcept;
};

/// The charts of one tester. The reference chart takes tests whose sample is the reference paper: S − K, or K
/// if its first test has no S − K, at that test's pull speed within 5 %; at unknown speeds if its
/// own is.
class TesterCharts {
 public:
  /// \param reference  name of the sample that is the reference paper; empty: its chart is off.
  explicit TesterCharts(std::string reference = {}) : reference_(std::move(reference)) {}

  /// The next test. \return the quantities that it newly alarms; none of a chart whose alarm still stands.
  std::vector<Quantity> add(const TestValues& test);
  /// Acknowledges: drops the standing alarm, if there is one, and sets both arms to 0.
  /// \param baseline_stays  true if nothing had changed: the baseline stays; false: the chart begins anew,
  /// without any value.
  void restart(Quantity quantity, bool baseline_stays);

  [[nodiscard]] const ChartState& state(Quantity quantity) const {
    return states_[static_cast<std::size_t>(quantity)];
  }
  [[nodiscard]] const std::string& reference() const noexcept { return reference_; }
  /// A finding `trend-…` for each standing alarm.
  [[nodiscard]] std::vector<base::Finding> findings() const;

 private:
  /// Value of the reference chart, or why the test gives none.
  [[nodiscard]] std::optional<double> reference_value(const TestValues& test, std::string& why);

  std::string reference_;
  /// What the reference chart compares, set by its first test since the restart.
  struct Compared {
    bool is_delta_mu = false;
    std::optional<double> pull_speed_m_per_s;
  };
  std::optional<Compared> compared_;
  std::array<ChartState, kQuantities> states_;
  struct TestName {
    std::string time;
    std::string file;
  };
  /// The latest tests of each chart: those of its excursion, one of which is the onset of an alarm.
  std::array<std::deque<TestName>, kQuantities> tests_;
};

}  // namespace stickslip::trend

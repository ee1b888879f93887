// The end of a journal, JSON and tables, and the runs of a sweep, which have the same results and truth.

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "core/record/enum_names.hpp"
#include "core/record/finding_json.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/json_fields.hpp"

namespace stickslip::record {
namespace {

constexpr const char* kParts = "systematic_parts";

void put_parts(Json& entry, const analysis::SystematicParts& parts) {
  for_each_part(parts, [&](analysis::UncertaintySource source, const std::optional<double>& size) {
    if (size) put(entry[kParts], name_of(source).name, size);
  });
}

void take_parts(const Json& entry, analysis::SystematicParts& parts) {
  const Json given = entry.value(kParts, Json::object());
  for_each_part(parts, [&](analysis::UncertaintySource source, std::optional<double>& size) {
    take(given, name_of(source).name, size);
  });
}

Json results_to_json(const analysis::TestResults& results) {
  Json object{{"regime", model::name(results.regime)},
              {"regime_reason", results.regime_reason},
              {"rung", analysis::name(results.rung)},
              {"rung_reason", results.rung_reason},
              {"misfit_place", results.misfit_place}};
  put_findings(results.findings, object);
  analysis::for_each_result(results,
                            [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
                              Json entry = Json::object();
                              put(entry, "value", estimate.value);
                              put(entry, "standard_error", estimate.standard_error);
                              put(entry, "systematic_uncertainty", estimate.systematic_uncertainty);
                              put_parts(entry, estimate.systematic_parts);
                              put(entry, "reason", estimate.reason);
                              object[std::string{name.name}] = std::move(entry);
                            });
  return object;
}

Json latency_to_json(const daq::LatencyHistogram& latency) {
  return {{"counts", latency.counts()}, {"largest", encode(latency.largest_s())}};
}

daq::LatencyHistogram latency_from_json(const Json& object) {
  double largest_s = 0.0;
  decode(object.at("largest"), largest_s);
  daq::LatencyHistogram::Counts counts{};
  for (std::size_t bin = 0; bin < counts.size(); ++bin) decode(object.at("counts").at(bin), counts[bin]);
  return {counts, largest_s};
}

analysis::TestResults results_from_json(const Json& object) {
  analysis::TestResults results;
  const auto regime = object.at("regime").get<std::string>();
  results.regime = word(regime, model::regime_from_name(regime));
  object.at("regime_reason").get_to(results.regime_reason);
  if (object.contains("rung")) {
    const auto rung = object.at("rung").get<std::string>();
    results.rung = word(rung, analysis::rung_from_name(rung));
    object.at("rung_reason").get_to(results.rung_reason);
    object.at("misfit_place").get_to(results.misfit_place);
  } else {
    results.rung_reason = kNoSuchResultThen;
  }
  results.findings = findings_in(object);
  analysis::for_each_result(results, [&](const analysis::ResultName& name, analysis::Estimate& estimate) {
    const Json entry = object.value(std::string{name.name}, Json{{"reason", kNoSuchResultThen}});
    take(entry, "value", estimate.value);
    take(entry, "standard_error", estimate.standard_error);
    take(entry, "systematic_uncertainty", estimate.systematic_uncertainty);
    take_parts(entry, estimate.systematic_parts);
    take(entry, "reason", estimate.reason);
  });
  return results;
}

Json truth_to_json(const model::TestTruth& truth) {
  Json object = fields_to_json(truth);
  object["regime"] = model::name(truth.regime);
  object["mode_count"] = truth.modes.size();
  object["cycle_count"] = truth.cycles.size();
  if (truth.solver) object["solver"] = fields_to_json(*truth.solver);
  return object;
}

model::TestTruth truth_from_json(const Json& object) {
  model::TestTruth truth;
  for_each_field(truth, taker(object));
  const auto regime = object.at("regime").get<std::string>();
  truth.regime = word(regime, model::regime_from_name(regime));
  if (object.contains("solver")) for_each_field(truth.solver.emplace(), taker(object.at("solver")));
  // Older journals have their tables here.
  for (const Json& entry : object.value("modes", Json::array())) {
    model::ModeInterval mode;
    decode(entry.at(0), mode.start_s);
    decode(entry.at(1), mode.end_s);
    const auto text = entry.at(2).get<std::string>();
    mode.mode = word(text, mode_from_name(text));
    truth.modes.push_back(mode);
  }
  for (const Json& entry : object.value("cycles", Json::array())) {
    model::TrueCycle slip;
    decode(entry.at(0), slip.onset_time_s);
    decode(entry.at(1), slip.mu_s);
    decode(entry.at(2), slip.mu_k);
    truth.cycles.push_back(slip);
  }
  return truth;
}

/// Bad UTF-8 as everywhere; without the tables, which are many numbers.
std::string end_to_json(const EndRecord& end) {
  Json object{{"status", name(end.status)},
              {"reasons", end.reasons},
              {"cause", end.cause},
              {"results", results_to_json(end.results)},
              {"spikes", end.spikes}};
  put(object, "end_realtime_ns", end.end_realtime_ns);
  put(object, "compute_time", end.compute_time_s);
  put(object, "unloaded_level", end.unloaded_level);
  if (end.read_latency) object["read_latency"] = latency_to_json(*end.read_latency);
  object["cycle_count"] = end.cycles.size();
  object["cycle_columns"] = cycle_columns();
  if (end.truth) object["truth"] = truth_to_json(*end.truth);
  return dump(object);
}

/// Numbers one after the other. \throws std::invalid_argument at the end of the bytes.
class TableReader {
 public:
  explicit TableReader(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size() / sizeof(double); }
  [[nodiscard]] double next() {
    if (left() == 0) throw std::invalid_argument("tables are cut short");
    double value = 0.0;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }
  /// \throws std::invalid_argument if it is no `Number`.
  template <typename Number>
  [[nodiscard]] Number next_as() {
    const double value = next();
    if constexpr (std::is_integral_v<Number>) {
      // 2⁶³ is a double, the largest of 64 bits is none.
      const bool fits = value >= static_cast<double>(std::numeric_limits<Number>::min()) &&
                        value < static_cast<double>(std::numeric_limits<Number>::max()) + 1.0 &&
                        value == std::trunc(value);
      if (!fits)
        throw std::invalid_argument(fmt::format("tables: {} is no whole number of its column", value));
    }
    return static_cast<Number>(value);
  }

 private:
  std::string_view bytes_;
};

/// As many rows as the object says, if they can be there at all.
std::size_t rows_told(const Json& object, std::string_view key, const TableReader& table) {
  const auto count = decoded<std::size_t>(object.at(std::string{key}));
  if (count > table.left()) throw std::invalid_argument("tables are cut short");
  return count;
}

model::Mode mode_of(double number) {
  for (const auto mode : {model::Mode::kStick, model::Mode::kSlip, model::Mode::kSlack}) {
    if (number == static_cast<double>(mode)) return mode;
  }
  throw std::invalid_argument(fmt::format("unknown mode {}", number));
}

void read_true_tables(const Json& truth, TableReader& table, model::TestTruth& tables) {
  for (std::size_t left = rows_told(truth, "mode_count", table); left > 0; --left) {
    tables.modes.push_back({table.next(), table.next(), mode_of(table.next())});  // Braces keep the order.
  }
  for (std::size_t left = rows_told(truth, "cycle_count", table); left > 0; --left) {
    model::TrueCycle cycle;
    for_each_true_cycle_column([&](const FieldName&, auto member) { cycle.*member = table.next(); });
    tables.cycles.push_back(cycle);
  }
}

/// Columns behind the known ones are those of a newer program, and are skipped.
/// \param object  of the end.
void read_tables(const Json& object, TableReader table, EndRecord& end) {
  const auto columns = object.contains("cycle_columns") ? decoded<std::size_t>(object.at("cycle_columns"))
                                                        : kFirstCycleColumns;
  for (std::size_t left = rows_told(object, "cycle_count", table); left > 0; --left) {
    detect::Cycle cycle;
    std::size_t column = 0;
    for_each_cycle_column([&](const FieldName&, auto member) {
      if (column++ < columns) cycle.*member = table.next_as<std::decay_t<decltype(cycle.*member)>>();
    });
    for (; column < columns; ++column) static_cast<void>(table.next());
    end.cycles.push_back(cycle);
  }
  if (end.truth) read_true_tables(object.at("truth"), table, *end.truth);
  if (table.left() > 0) {
    throw std::invalid_argument(fmt::format(
        "tables have {} numbers more than this program knows: read it with the version that wrote it",
        table.left()));
  }
}

}  // namespace

void append_end_bytes(const EndRecord& end, std::vector<std::byte>& bytes) {
  const std::string json_text = end_to_json(end);
  const auto text = std::as_bytes(std::span{json_text});
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.push_back(std::byte{0});
  const auto add = [&](double value) {
    const auto number = std::as_bytes(std::span{&value, 1});
    bytes.insert(bytes.end(), number.begin(), number.end());
  };
  for (const detect::Cycle& cycle : end.cycles) {
    for_each_cycle_column([&](const FieldName&, auto member) { add(static_cast<double>(cycle.*member)); });
  }
  if (!end.truth) return;
  for (const model::ModeInterval& mode : end.truth->modes) {
    add(mode.start_s);
    add(mode.end_s);
    add(static_cast<double>(mode.mode));
  }
  for (const model::TrueCycle& cycle : end.truth->cycles) {
    for_each_true_cycle_column([&](const FieldName&, auto member) { add(cycle.*member); });
  }
}

EndRecord end_from_bytes(std::span<const std::byte> bytes) {
  const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  const Json object = Json::parse(text.substr(0, text.find('\0')));
  EndRecord end;
  const auto status = object.at("status").get<std::string>();
  end.status = word(status, status_from_name(status));
  object.at("reasons").get_to(end.reasons);
  object.at("cause").get_to(end.cause);
  take(object, "end_realtime_ns", end.end_realtime_ns);
  take(object, "compute_time", end.compute_time_s);
  take(object, "unloaded_level", end.unloaded_level);
  if (object.contains("read_latency")) end.read_latency = latency_from_json(object.at("read_latency"));
  end.results = results_from_json(object.at("results"));
  for (const Json& spike : object.at("spikes")) end.spikes.push_back(decoded<daq::ScanIndex>(spike));
  for (const Json& row : object.value("cycles", Json::array())) end.cycles.push_back(cycle_from_array(row));
  if (object.contains("truth")) end.truth = truth_from_json(object.at("truth"));
  if (const auto tables = text.find('\0'); tables != std::string_view::npos) {
    read_tables(object, TableReader{text.substr(tables + 1)}, end);
  }
  return end;
}

std::string sweep_run_to_json(const SweepRun& run) {
  return dump({{"run", run.number},
               {"results", results_to_json(run.results)},
               {"truth", truth_to_json(run.truth)},
               {"true_cycle_count", run.true_cycle_count}});
}

SweepRun sweep_run_from_json(std::string_view text) {
  const Json object = Json::parse(text);
  return {decoded<std::int64_t>(object.at("run")), results_from_json(object.at("results")),
          truth_from_json(object.at("truth")), decoded<std::int64_t>(object.at("true_cycle_count"))};
}

}  // namespace stickslip::record

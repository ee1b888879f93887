#include "core/record/json_codec.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "core/record/fields.hpp"
#include "core/record/possible.hpp"
#include "core/record/words.hpp"

namespace stickslip::record {
namespace {

using nlohmann::json;

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};
/// Empty stands for not known.
template <typename T>
concept Many = std::is_same_v<T, std::string> || std::is_same_v<T, std::vector<double>> ||
    std::is_same_v<T, std::vector<std::string>>;

json encode(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return nullptr;
  return value > 0.0 ? "inf" : "-inf";
}

template <typename T>
json encode(const T& value) {
  if constexpr (std::is_same_v<T, std::vector<double>>) {
    json array = json::array();
    for (const double number : value) array.push_back(encode(number));
    return array;
  } else {
    return value;
  }
}

void decode(const json& from, double& value) {
  if (from.is_null()) {
    value = std::numeric_limits<double>::quiet_NaN();
  } else if (from.is_string()) {
    value =
        from == "inf" ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
  } else {
    from.get_to(value);
  }
}

template <typename T>
void decode(const json& from, T& value) {
  if constexpr (std::is_same_v<T, std::vector<double>>) {
    value.assign(from.size(), 0.0);
    for (std::size_t i = 0; i < value.size(); ++i) decode(from.at(i), value[i]);
  } else {
    from.get_to(value);
  }
}

/// Writes a value under its key; absent optionals, empty texts and columns get none.
template <typename T>
void put(json& object, std::string_view key, const T& value) {
  if constexpr (IsOptional<T>::value) {
    if (value) object[std::string{key}] = encode(*value);
  } else if constexpr (Many<T>) {
    if (!value.empty()) object[std::string{key}] = encode(value);
  } else {
    object[std::string{key}] = encode(value);
  }
}

template <typename T>
void take(const json& object, std::string_view key, T& value) {
  const auto found = object.find(std::string{key});
  if constexpr (IsOptional<T>::value) {
    value.reset();
    if (found != object.end()) decode(*found, value.emplace());
  } else if constexpr (Many<T>) {
    value.clear();
    if (found != object.end()) decode(*found, value);
  } else {
    if (found == object.end()) throw std::invalid_argument(fmt::format("{} is missing", key));
    decode(*found, value);
  }
}

auto putter(json& object) {
  return [&object](const FieldName& name, const auto& value) { put(object, name.name, value); };
}
auto taker(const json& object) {
  return [&object](const FieldName& name, auto& value) { take(object, name.name, value); };
}

template <typename Facts>
json facts_to_json(const Facts& facts) {
  json object = json::object();
  for_each_field(facts, putter(object));
  return object;
}

template <typename Value>
Value word(const std::string& text, std::optional<Value> value) {
  if (!value) throw std::invalid_argument(fmt::format("unknown word '{}'", text));
  return *value;
}

/// Columns of a cycle in the first journals; what came later may be missing.
constexpr std::size_t kFirstCycleColumns = 15;

std::size_t cycle_columns() {
  std::size_t count = 0;
  for_each_cycle_column([&](const FieldName&, auto) { ++count; });
  return count;
}

json cycle_to_array(const friction::Cycle& cycle) {
  json array = json::array();
  for_each_cycle_column([&](const FieldName&, auto member) { array.push_back(encode(cycle.*member)); });
  return array;
}

friction::Cycle cycle_from_array(const json& array) {
  friction::Cycle cycle;
  std::size_t i = 0;
  for_each_cycle_column([&](const FieldName&, auto member) {
    if (i < kFirstCycleColumns || i < array.size()) decode(array.at(i), cycle.*member);
    ++i;
  });
  return cycle;
}

json results_to_json(const friction::TestResults& results) {
  json object{{"regime", friction::name(results.regime)},
              {"regime_reason", results.regime_reason},
              {"findings", results.findings}};
  friction::for_each_result(results,
                            [&](const friction::ResultName& name, const friction::Estimate& estimate) {
                              json entry = json::object();
                              put(entry, "value", estimate.value);
                              put(entry, "standard_error", estimate.standard_error);
                              put(entry, "systematic_uncertainty", estimate.systematic_uncertainty);
                              put(entry, "reason", estimate.reason);
                              object[std::string{name.name}] = std::move(entry);
                            });
  return object;
}

json latency_to_json(const daq::LatencyHistogram& latency) {
  return {{"counts", latency.counts()}, {"largest", latency.largest_s()}};
}

daq::LatencyHistogram latency_from_json(const json& object) {
  return {object.at("counts").get<daq::LatencyHistogram::Counts>(), object.at("largest").get<double>()};
}

friction::TestResults results_from_json(const json& object) {
  friction::TestResults results;
  const auto regime = object.at("regime").get<std::string>();
  results.regime = word(regime, friction::regime_from_name(regime));
  object.at("regime_reason").get_to(results.regime_reason);
  results.findings = object.value("findings", std::vector<std::string>{});
  friction::for_each_result(results, [&](const friction::ResultName& name, friction::Estimate& estimate) {
    const json entry = object.value(std::string{name.name}, json{{"reason", kNoSuchResultThen}});
    take(entry, "value", estimate.value);
    take(entry, "standard_error", estimate.standard_error);
    take(entry, "systematic_uncertainty", estimate.systematic_uncertainty);
    take(entry, "reason", estimate.reason);
  });
  return results;
}

json truth_to_json(const friction::TestTruth& truth) {
  json object = facts_to_json(truth);
  object["regime"] = friction::name(truth.regime);
  object["mode_count"] = truth.modes.size();
  object["cycle_count"] = truth.cycles.size();
  if (truth.solver) object["solver"] = facts_to_json(*truth.solver);
  return object;
}

friction::TestTruth truth_from_json(const json& object) {
  friction::TestTruth truth;
  for_each_field(truth, taker(object));
  const auto regime = object.at("regime").get<std::string>();
  truth.regime = word(regime, friction::regime_from_name(regime));
  if (object.contains("solver")) for_each_field(truth.solver.emplace(), taker(object.at("solver")));
  // Older journals have their tables here.
  for (const json& entry : object.value("modes", json::array())) {
    friction::ModeInterval mode;
    decode(entry.at(0), mode.start_s);
    decode(entry.at(1), mode.end_s);
    const auto text = entry.at(2).get<std::string>();
    mode.mode = word(text, mode_from_name(text));
    truth.modes.push_back(mode);
  }
  for (const json& entry : object.value("cycles", json::array())) {
    friction::TrueCycle slip;
    decode(entry.at(0), slip.onset_time_s);
    decode(entry.at(1), slip.mu_s);
    decode(entry.at(2), slip.mu_k);
    truth.cycles.push_back(slip);
  }
  return truth;
}

/// Bad UTF-8 (a configuration file may hold anything) is replaced, never a reason to lose a test.
std::string dump(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

}  // namespace

std::string header_to_json(const RecordHeader& header) {
  json board = json::object();
  for_each_name_field(header.board, putter(board));
  for_each_converter_field(header.board, putter(board));
  for_each_rate_field(header.board, putter(board));
  board["quantity"] = name(header.board.quantity).name;
  if (header.board.second) {
    board["second"] = facts_to_json(*header.board.second);
    board["second"]["quantity"] = daq::name(header.board.second->quantity);
  }

  json object{{"format", kFormat},
              {"format_version", kFormatVersion},
              {"board", std::move(board)},
              {"calibration", facts_to_json(header.calibration)},
              {"tester", facts_to_json(header.tester)},
              {"sample", facts_to_json(header.sample)},
              {"process", facts_to_json(header.process)}};
  put(object, "uuid", header.uuid);
  put(object, "title", header.title);
  put(object, "test_number", header.test_number);
  put(object, "trigger_scan", header.trigger_scan);
  put(object, "start_realtime_ns", header.start_realtime_ns);
  put(object, "operator", header.sample.operator_name);
  if (header.load_cell) object["load_cell"] = facts_to_json(*header.load_cell);
  if (const json plan = facts_to_json(header.plan); !plan.empty()) object["plan"] = plan;
  if (header.self_check) {
    object["self_check"] = facts_to_json(*header.self_check);
    put(object["self_check"], "raw", header.self_check->raw);
  }
  return dump(object);
}

RecordHeader header_from_json(std::string_view text) {
  const json object = json::parse(text);
  if (object.at("format") != kFormat) {
    throw std::invalid_argument(
        fmt::format("format {}, this program reads {}", object.at("format").dump(), kFormat));
  }
  if (const std::string refusal = version_refusal(object.at("format_version").get<std::int64_t>());
      !refusal.empty()) {
    throw std::invalid_argument(refusal);
  }
  RecordHeader header;
  const json& board = object.at("board");
  for_each_name_field(header.board, taker(board));
  for_each_converter_field(header.board, taker(board));
  for_each_rate_field(header.board, taker(board));
  const auto quantity = board.at("quantity").get<std::string>();
  header.board.quantity = word(quantity, quantity_from_name(quantity));
  if (board.contains("second")) {
    daq::SecondChannel& second = header.board.second.emplace();
    const auto measured = board.at("second").at("quantity").get<std::string>();
    second.quantity = word(measured, daq::second_quantity_from_name(measured));
    for_each_field(second, taker(board.at("second")));
  }
  for_each_field(header.calibration, taker(object.at("calibration")));
  for_each_field(header.tester, taker(object.at("tester")));
  for_each_field(header.sample, taker(object.at("sample")));
  for_each_field(header.process, taker(object.at("process")));
  take(object, "uuid", header.uuid);
  take(object, "title", header.title);
  take(object, "test_number", header.test_number);
  take(object, "trigger_scan", header.trigger_scan);
  take(object, "start_realtime_ns", header.start_realtime_ns);
  take(object, "operator", header.sample.operator_name);
  if (object.contains("load_cell")) {
    for_each_field(header.load_cell.emplace(), taker(object.at("load_cell")));
  }
  if (object.contains("plan")) for_each_field(header.plan, taker(object.at("plan")));
  if (object.contains("self_check")) {
    const json& check = object.at("self_check");
    for_each_field(header.self_check.emplace(), taker(check));
    take(check, "raw", header.self_check->raw);
  }
  return header;
}

std::string gap_to_json(const daq::Gap& gap) {
  return dump({{"first_scan", gap.first},
               {"scan_count", gap.count},
               {"estimated", gap.estimated},
               {"cause", daq::name(gap.cause)}});
}

daq::Gap gap_from_json(std::string_view text) {
  const json object = json::parse(text);
  const auto cause = object.at("cause").get<std::string>();
  return possible(daq::Gap{object.at("first_scan").get<daq::ScanIndex>(),
                           object.at("scan_count").get<std::int64_t>(), object.at("estimated").get<bool>(),
                           word(cause, gap_cause_from_name(cause))});
}

std::string cycle_to_json(const friction::Cycle& cycle) { return dump(cycle_to_array(cycle)); }

friction::Cycle cycle_from_json(std::string_view text) { return cycle_from_array(json::parse(text)); }

std::string event_to_json(const Event& event) {
  return dump({{"scan", event.scan}, {"realtime_ns", event.realtime_ns}, {"text", event.text}});
}

Event event_from_json(std::string_view text) {
  const json object = json::parse(text);
  return {possible(object.at("scan").get<daq::ScanIndex>()), object.at("realtime_ns").get<std::int64_t>(),
          object.at("text").get<std::string>()};
}

namespace {

/// Bad UTF-8 as everywhere; without the tables, which are many numbers.
std::string end_to_json(const EndRecord& end) {
  json object{{"status", name(end.status)},
              {"reasons", end.reasons},
              {"cause", end.cause},
              {"results", results_to_json(end.results)},
              {"spikes", end.spikes}};
  put(object, "end_realtime_ns", end.end_realtime_ns);
  put(object, "compute_time", end.compute_time_s);
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

 private:
  std::string_view bytes_;
};

/// As many rows as the object says, if they can be there at all.
std::size_t rows_told(const json& object, std::string_view key, const TableReader& table) {
  const auto count = object.at(std::string{key}).get<std::size_t>();
  if (count > table.left()) throw std::invalid_argument("tables are cut short");
  return count;
}

friction::Mode mode_of(double number) {
  for (const auto mode : {friction::Mode::kStick, friction::Mode::kSlip, friction::Mode::kSlack}) {
    if (number == static_cast<double>(mode)) return mode;
  }
  throw std::invalid_argument(fmt::format("unknown mode {}", number));
}

/// \param object  of the end.
void read_tables(const json& object, TableReader table, EndRecord& end) {
  const auto columns = object.value("cycle_columns", kFirstCycleColumns);
  for (std::size_t left = rows_told(object, "cycle_count", table); left > 0; --left) {
    friction::Cycle cycle;
    std::size_t column = 0;
    for_each_cycle_column([&](const FieldName&, auto member) {
      if (column++ < columns)
        cycle.*member = static_cast<std::decay_t<decltype(cycle.*member)>>(table.next());
    });
    end.cycles.push_back(cycle);
  }
  if (!end.truth) return;
  for (std::size_t left = rows_told(object.at("truth"), "mode_count", table); left > 0; --left) {
    end.truth->modes.push_back(
        {table.next(), table.next(), mode_of(table.next())});  // Braces keep the order.
  }
  for (std::size_t left = rows_told(object.at("truth"), "cycle_count", table); left > 0; --left) {
    friction::TrueCycle cycle;
    for_each_true_cycle_column([&](const FieldName&, auto member) { cycle.*member = table.next(); });
    end.truth->cycles.push_back(cycle);
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
  for (const friction::Cycle& cycle : end.cycles) {
    for_each_cycle_column([&](const FieldName&, auto member) { add(static_cast<double>(cycle.*member)); });
  }
  if (!end.truth) return;
  for (const friction::ModeInterval& mode : end.truth->modes) {
    add(mode.start_s);
    add(mode.end_s);
    add(static_cast<double>(mode.mode));
  }
  for (const friction::TrueCycle& cycle : end.truth->cycles) {
    for_each_true_cycle_column([&](const FieldName&, auto member) { add(cycle.*member); });
  }
}

EndRecord end_from_bytes(std::span<const std::byte> bytes) {
  const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  const json object = json::parse(text.substr(0, text.find('\0')));
  EndRecord end;
  const auto status = object.at("status").get<std::string>();
  end.status = word(status, status_from_name(status));
  object.at("reasons").get_to(end.reasons);
  object.at("cause").get_to(end.cause);
  take(object, "end_realtime_ns", end.end_realtime_ns);
  take(object, "compute_time", end.compute_time_s);
  if (object.contains("read_latency")) end.read_latency = latency_from_json(object.at("read_latency"));
  end.results = results_from_json(object.at("results"));
  object.at("spikes").get_to(end.spikes);
  for (const json& row : object.value("cycles", json::array())) end.cycles.push_back(cycle_from_array(row));
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
  const json object = json::parse(text);
  return {object.at("run").get<std::int64_t>(), results_from_json(object.at("results")),
          truth_from_json(object.at("truth")), object.at("true_cycle_count").get<std::int64_t>()};
}

}  // namespace stickslip::record

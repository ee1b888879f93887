/// \file
/// Reading and writing of values under keys in JSON, for the entries of a journal.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/record/fields.hpp"

namespace stickslip::record {

using Json = nlohmann::json;

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};
/// Types whose empty value means unknown.
template <typename T>
concept Many = std::is_same_v<T, std::string> || std::is_same_v<T, std::vector<double>> ||
    std::is_same_v<T, std::vector<std::string>>;

/// A value in JSON. A double that is NaN becomes null, an infinite one "inf" or "-inf".
inline Json encode(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return nullptr;
  return value > 0.0 ? "inf" : "-inf";
}

template <typename T>
Json encode(const T& value) {
  if constexpr (std::is_same_v<T, std::vector<double>>) {
    Json array = Json::array();
    for (const double number : value) array.push_back(encode(number));
    return array;
  } else {
    return value;
  }
}

/// Inverse of encode(). \throws std::exception for JSON of another type, and for a whole number beyond those
/// of its type.
inline void decode(const Json& from, double& value) {
  if (from.is_null()) {
    value = std::numeric_limits<double>::quiet_NaN();
  } else if (from.is_string()) {
    const bool is_below = from == "-inf";
    if (!is_below && from != "inf") throw std::invalid_argument(from.dump() + " is no number");
    value = (is_below ? -1.0 : 1.0) * std::numeric_limits<double>::infinity();
  } else {
    from.get_to(value);
  }
}

template <typename T>
void decode(const Json& from, T& value) {
  if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    const bool fits = from.is_number_unsigned()  ? std::in_range<T>(from.get<std::uint64_t>())
                      : from.is_number_integer() ? std::in_range<T>(from.get<std::int64_t>())
                                                 : false;
    if (!fits) throw std::invalid_argument(from.dump() + " is no such whole number");
    value = from.get<T>();
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    if (!from.is_array()) throw std::invalid_argument(from.dump() + " is no column");
    value.assign(from.size(), 0.0);
    for (std::size_t i = 0; i < value.size(); ++i) decode(from.at(i), value[i]);
  } else {
    from.get_to(value);
  }
}

/// A value of this type, by decode().
template <typename T>
[[nodiscard]] T decoded(const Json& from) {
  T value{};
  decode(from, value);
  return value;
}

/// Writes a value under its key. Writes nothing for an absent optional and an empty text or column.
template <typename T>
void put(Json& object, std::string_view key, const T& value) {
  if constexpr (IsOptional<T>::value) {
    if (value) object[std::string{key}] = encode(*value);
  } else if constexpr (Many<T>) {
    if (!value.empty()) object[std::string{key}] = encode(value);
  } else {
    object[std::string{key}] = encode(value);
  }
}

/// Reads the value under a key; inverse of put(). Without the key an optional, text or column becomes empty.
/// \throws std::exception if any other value is missing, or as decode().
template <typename T>
void take(const Json& object, std::string_view key, T& value) {
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

/// Visitor for for_each_field(): put() of each field under its name.
inline auto putter(Json& object) {
  return [&object](const FieldName& name, const auto& value) { put(object, name.name, value); };
}
/// Visitor for for_each_field(): take() of each field from under its name.
inline auto taker(const Json& object) {
  return [&object](const FieldName& name, auto& value) { take(object, name.name, value); };
}

/// An object with all fields, by put().
template <typename Fields>
Json fields_to_json(const Fields& fields) {
  Json object = Json::object();
  for_each_field(fields, putter(object));
  return object;
}

/// `value`, to which `text` was translated. \throws std::invalid_argument that quotes `text` if it is absent.
template <typename Value>
Value word(const std::string& text, std::optional<Value> value) {
  if (!value) throw std::invalid_argument(fmt::format("unknown word '{}'", text));
  return *value;
}

/// The text of a value, in one line. Bytes that are not UTF-8 (a configuration file may hold any) are
/// replaced by U+FFFD.
inline std::string dump(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Number of columns of a cycle in the oldest journals; later columns may be missing.
inline constexpr std::size_t kFirstCycleColumns = 15;

/// Number of columns of a cycle in this version.
inline std::size_t cycle_columns() {
  std::size_t count = 0;
  for_each_cycle_column([&](const FieldName&, auto) { ++count; });
  return count;
}

/// The columns of a cycle, in the order of for_each_cycle_column().
inline Json cycle_to_array(const detect::Cycle& cycle) {
  Json array = Json::array();
  for_each_cycle_column([&](const FieldName&, auto member) { array.push_back(encode(cycle.*member)); });
  return array;
}

/// Inverse of cycle_to_array(). Later columns that are missing have their defaults; columns behind the known
/// ones are ignored. \throws std::exception if one of the first kFirstCycleColumns is missing, or as
/// decode().
inline detect::Cycle cycle_from_array(const Json& array) {
  detect::Cycle cycle;
  std::size_t i = 0;
  for_each_cycle_column([&](const FieldName&, auto member) {
    if (i < kFirstCycleColumns || i < array.size()) decode(array.at(i), cycle.*member);
    ++i;
  });
  return cycle;
}

}  // namespace stickslip::record

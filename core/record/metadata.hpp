/// \file
/// Facts of a test under keys, as text: "temperature" = "23 degC", "instrument" = "TMI 32-06". Some keys are
/// known: their values are checked where they are stated, and have a number.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/quantity.hpp"
#include "core/base/result.hpp"

namespace stickslip::record {

inline constexpr std::size_t kMostMetadata = 100;  ///< Keys of one record.
inline constexpr std::size_t kLongestMetadataKey = 64;

using Metadata = std::map<std::string, std::string, std::less<>>;

/// A key whose meaning is known.
struct KnownFact {
  std::string_view key;
  std::string_view long_name;  ///< As of a field of the record.
  std::string_view unit;       ///< Of fact_number(): "degC", "1", "s"; empty: it is a text.
  base::Dimension dimension = base::Dimension::kDimensionless;
  // In `unit`.
  double lowest = 0.0;
  double highest = 0.0;
  std::string_view example;  ///< "23 degC"
};

/// temperature, humidity, conditioning, contact_time, lot.
[[nodiscard]] std::span<const KnownFact> known_facts() noexcept;

/// Of the sample: a batch of another sample does not keep it.
inline constexpr std::string_view kLot = "lot";

/// The number that a known fact states, in its unit. Errors: kUsage, the message begins with the key: text
/// that is no such quantity, a number outside the fact's range, a key without a number.
[[nodiscard]] base::Result<double> fact_number(std::string_view key, std::string_view value);

/// Reason why this pair is refused in a record, with the remedy; empty if it is accepted. A key is a letter
/// and then letters, digits, '_', '-' and '.', ASCII; a value is as base::name_refusal() accepts it and not
/// empty.
[[nodiscard]] std::string metadata_refusal(std::string_view key, std::string_view value);

/// Why a known fact of this value has no number; empty: it has one, or it is no fact with a number. Records
/// of older versions and imports may hold such texts.
[[nodiscard]] std::string why_no_number(std::string_view key, std::string_view value);

/// Sets a fact; an empty value removes it. Errors: kUsage for a refused pair, a known fact without its
/// number, or more than kMostMetadata keys; the message begins with the key.
[[nodiscard]] base::Result<void> set_fact(Metadata& metadata, std::string_view key, std::string_view value);

/// The facts of both; of a key in both that of `above`. Keys of `below` beyond kMostMetadata are left out.
[[nodiscard]] Metadata merged(const Metadata& below, Metadata above);

/// Splits "key=value" or "key = value"; the value may have further '='. Errors: kUsage without '='.
[[nodiscard]] base::Result<std::pair<std::string, std::string>> split_fact(std::string_view pair);

/// Adds "key=value", of any key. Errors: kUsage for a refused pair, a key that is there already, or more than
/// kMostMetadata keys. \param place  in front of the message: "--set-meta".
[[nodiscard]] base::Result<void> add_metadata(Metadata& metadata, std::string_view pair,
                                              std::string_view place);

}  // namespace stickslip::record

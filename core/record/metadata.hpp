/// \file
/// Facts of a test under keys, as text: "temperature" = "23 degC", "instrument" = "TMI 32-06". Some keys are
/// known. The value of some of these states a number, which set_fact() checks.
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

inline constexpr std::size_t kMostMetadata = 100;       ///< Keys of one record.
inline constexpr std::size_t kLongestMetadataKey = 64;  ///< Bytes.

using Metadata = std::map<std::string, std::string, std::less<>>;

/// A key whose meaning is known.
struct KnownFact {
  std::string_view key;
  std::string_view long_name;  ///< "relative humidity of the air"; empty for a text.
  std::string_view unit;       ///< Unit of fact_number(): "degC", "1", "s"; empty: the fact is a text.
  base::Dimension dimension = base::Dimension::kDimensionless;
  // Accepted numbers, in `unit`, both included.
  double lowest = 0.0;
  double highest = 0.0;
  std::string_view example;  ///< A value, such as "23 degC"; empty for a text.
};

/// The known facts: temperature, humidity, contact_time; and the texts conditioning, lot.
[[nodiscard]] std::span<const KnownFact> known_facts() noexcept;

/// Key of the sample's lot. Of the facts told before a batch, it alone is not taken over into the batch.
inline constexpr std::string_view kLot = "lot";

/// The number that a known fact states, in its unit. Errors: kUsage, with the key in front, for a text that
/// is no such quantity, a number outside the fact's range, and a key that is unknown or has no number.
[[nodiscard]] base::Result<double> fact_number(std::string_view key, std::string_view value);

/// Reason why this pair is refused in a record, with the key in front and the remedy; empty if it is
/// accepted. A key is an ASCII letter and then ASCII letters, digits, '_', '-' and '.', at most
/// kLongestMetadataKey in all. A value is printable UTF-8 of 1 to 200 bytes (base::name_refusal()); the
/// number of a known fact is not checked.
[[nodiscard]] std::string metadata_refusal(std::string_view key, std::string_view value);

/// The error of fact_number() for a fact that should have a number; empty if it has one, or if no number
/// belongs to the key. Records of older versions and imports may hold values without their number.
[[nodiscard]] std::string why_no_number(std::string_view key, std::string_view value);

/// Sets a fact, also one that is there; an empty value removes it, if it is there. Errors: kUsage, with the
/// key in front, for a pair that metadata_refusal() refuses, a known fact without its number, or more than
/// kMostMetadata keys.
[[nodiscard]] base::Result<void> set_fact(Metadata& metadata, std::string_view key, std::string_view value);

/// The facts of both; of a key in both that of `above`. Keys of `below` beyond kMostMetadata are left out.
[[nodiscard]] Metadata merged(const Metadata& below, Metadata above);

/// Splits "key=value" or "key = value" at the first '=', without blanks and tabs around both; either may be
/// empty. Errors: kUsage without '='.
[[nodiscard]] base::Result<std::pair<std::string, std::string>> split_fact(std::string_view pair);

/// Adds "key=value" (split_fact()); the value of a known fact need not state its number. Errors: kUsage
/// without '=', for a pair that metadata_refusal() refuses, a key that is there already, or more than
/// kMostMetadata keys. \param place  in front of the message: "--set-meta".
[[nodiscard]] base::Result<void> add_metadata(Metadata& metadata, std::string_view pair,
                                              std::string_view place);

}  // namespace stickslip::record

/// \file
/// Free facts of a record under keys that the user chooses, as text: "humidity" = "52 %".
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::record {

inline constexpr std::size_t kMostMetadata = 100;  ///< Keys of one record.
inline constexpr std::size_t kLongestMetadataKey = 64;

using Metadata = std::map<std::string, std::string, std::less<>>;

/// Reason why this pair is refused, with the remedy; empty if it is accepted. A key is a letter and then
/// letters, digits, '_', '-' and '.', ASCII; a value is as base::name_refusal() accepts it and not empty.
[[nodiscard]] std::string metadata_refusal(std::string_view key, std::string_view value);

/// Adds "key=value"; the value may have further '='. Errors: kUsage for a refused pair, a key that is there
/// already, or more than kMostMetadata keys. \param place  in front of the message: "--set-meta".
[[nodiscard]] base::Result<void> add_metadata(Metadata& metadata, std::string_view pair,
                                              std::string_view place);

}  // namespace stickslip::record

/// \file
/// Values of JSON objects. Quantities in the bodies of requests: text with a unit ("mass": "500 g"), or a
/// number under a key that names the SI unit ("mass_kg": 0.5). Texts of lines of a journal.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/base/quantity.hpp"
#include "core/base/result.hpp"

namespace stickslip::daemon {

/// Warnings to the client, for HttpReply::warning.
using Warnings = std::vector<std::string>;

/// Joins them with "; ". Those that would make the text longer than 2000 bytes are counted: parsers of
/// replies refuse long headers.
[[nodiscard]] std::string text_of(const Warnings& warnings);

/// "mass_kg", "pull_speed_m_per_s": the key under which a number alone is legal.
[[nodiscard]] std::string key_with_unit(std::string_view key, base::Dimension dimension);

/// Reads one value. \param bare  how a number under a key without the unit is taken; in text it is refused
/// unless it may be 0. \param warnings  takes one for each key; may be null: nobody is warned, as for files
/// that the daemon wrote.
/// Errors (kUsage) name the key.
[[nodiscard]] base::Result<double> quantity_of(std::string_view key, const nlohmann::ordered_json& value,
                                               base::Dimension dimension, base::BareNumber bare,
                                               Warnings* warnings);

/// Reads `key` or key_with_unit() of an object; nothing if both are absent or null. Errors (kUsage): as
/// above, and if both are given.
[[nodiscard]] base::Result<std::optional<double>> quantity_at(const nlohmann::ordered_json& object,
                                                              std::string_view key, base::Dimension dimension,
                                                              base::BareNumber bare, Warnings* warnings);

/// A text of an object. Errors (kUsage): it is missing, or is no text.
[[nodiscard]] base::Result<std::string> text_at(const nlohmann::ordered_json& object, const char* key);

}  // namespace stickslip::daemon

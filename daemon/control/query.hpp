/// \file
/// The parameters of a request, behind the "?" of its target.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::control {

/// "%2C" is a comma [RFC 3986, section 2.1]. Nothing if two hexadecimal digits do not follow each "%".
[[nodiscard]] std::optional<std::string> decoded(std::string_view value);

using Query = std::map<std::string, std::string>;

/// Values are percent-decoded. \param keys  the allowed ones. Errors: kUsage.
[[nodiscard]] base::Result<Query> query_of(const std::string& target,
                                           std::initializer_list<std::string_view> keys);

/// A whole number of the query from 1 to `most`; `usual` if there is none. Errors: kUsage.
[[nodiscard]] base::Result<std::size_t> count_in(const Query& query, const std::string& key,
                                                 std::size_t usual, std::size_t most);

}  // namespace stickslip::control

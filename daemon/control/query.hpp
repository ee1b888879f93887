/// \file
/// The parameters of a request, behind the "?" of its target.
#pragma once

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::control {

using Query = std::map<std::string, std::string>;

/// Values are percent-decoded. \param keys  the allowed ones. Errors: kUsage.
[[nodiscard]] base::Result<Query> query_of(const std::string& target,
                                           std::initializer_list<std::string_view> keys);

}  // namespace stickslip::control

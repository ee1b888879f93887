/// \file
/// Serves the live page. Its files are in the program's memory and found by name, so that no path from
/// outside reaches the file system.
#pragma once

#include "report/chart_library.hpp"

#include "core/base/result.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::page {

/// \param api  gets all other requests.
/// \param charts  if it is an error, requests for the page are answered by 503 and the reason.
[[nodiscard]] daemon::HttpHandler make_site(daemon::HttpHandler api,
                                            const base::Result<report::ChartLibrary>& charts);

}  // namespace stickslip::page

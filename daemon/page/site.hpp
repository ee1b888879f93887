/// \file
/// The live page in front of the control interface: its few files by name, out of the program's memory, so
/// that no path from outside ever reaches a folder.
#pragma once

#include "report/chart_library.hpp"

#include "core/base/result.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::page {

/// \param api  gets every request that is none for the page.
/// \param charts  where they could not be read the page is answered by 503 and the reason.
[[nodiscard]] daemon::HttpHandler make_site(daemon::HttpHandler api,
                                            const base::Result<report::ChartLibrary>& charts);

}  // namespace stickslip::page

/// \file
/// The live page in front of the control interface: its few files by name, out of the program's memory, so
/// that no path from outside ever reaches a folder.
#pragma once

#include "core/base/result.hpp"
#include "daemon/control/http.hpp"
#include "daemon/web/chart_library.hpp"

namespace stickslip::daemon {

/// \param api  gets every request that is none for the page.
/// \param charts  where they could not be read the page is answered by 503 and the reason.
[[nodiscard]] HttpHandler make_site(HttpHandler api, const base::Result<ChartLibrary>& charts);

}  // namespace stickslip::daemon

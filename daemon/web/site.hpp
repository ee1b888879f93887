/// \file
/// The live page in front of the control interface: its few files by name, out of the program itself, so that
/// no path from outside ever reaches a folder.
#pragma once

#include "daemon/control/http.hpp"

namespace stickslip::daemon {

/// \param api  gets every request that is none for the page.
[[nodiscard]] HttpHandler make_site(HttpHandler api);

}  // namespace stickslip::daemon

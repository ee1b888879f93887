/// \file
/// Who has the bench, for status and replies.
#pragma once

#include <string>

namespace stickslip::daemon {

struct LeaseState {
  std::string controller;     ///< Name of who has the bench; empty: nobody.
  double seconds_left = 0.0;  ///< Until the lease ends; 0 if nobody has the bench.
};

}  // namespace stickslip::daemon

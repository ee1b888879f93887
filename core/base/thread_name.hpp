/// \file
/// A thread's name, as top(1), gdb and journald show it.
#pragma once

#include <pthread.h>

namespace stickslip::base {

/// Sets the name of the calling thread. \param name  at most 15 bytes; a longer one has no effect.
inline void name_this_thread(const char* name) noexcept {
  // A failure is harmless.
  static_cast<void>(::pthread_setname_np(::pthread_self(), name));
}

}  // namespace stickslip::base

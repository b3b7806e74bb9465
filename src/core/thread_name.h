#pragma once

#if defined(__linux__)
#include <pthread.h>
#endif

namespace diminish {

/// Names the calling thread, and those that it begins and that name themselves no other way: for
/// `top -H`, debuggers, and whoever counts threads. Up to 15 characters.
inline void name_this_thread([[maybe_unused]] const char* name) {
#if defined(__linux__)
  pthread_setname_np(pthread_self(), name);
#endif
}

}  // namespace diminish

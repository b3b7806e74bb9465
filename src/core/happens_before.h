#pragma once

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#include <sanitizer/tsan_interface.h>
#define DIMINISH_THREAD_SANITIZER
#endif
#endif

/// For a lambda that oneTBB calls: what it captured was written in an order that only oneTBB knows.
/// What it calls is looked at.
#ifdef DIMINISH_THREAD_SANITIZER
#define DIMINISH_UNSANITIZED_THREADS __attribute__((no_sanitize("thread")))
#else
#define DIMINISH_UNSANITIZED_THREADS
#endif

namespace diminish {

// What the thread sanitizer cannot see, since oneTBB is not built with it: whatever a thread did
// before happens_before(place) is done for the one that calls happens_after(place) later. Nothing
// in other builds: they state what oneTBB guarantees, and guarantee nothing.

inline void happens_before([[maybe_unused]] const void* place) {
#ifdef DIMINISH_THREAD_SANITIZER
  __tsan_release(const_cast<void*>(place));
#endif
}

inline void happens_after([[maybe_unused]] const void* place) {
#ifdef DIMINISH_THREAD_SANITIZER
  __tsan_acquire(const_cast<void*>(place));
#endif
}

}  // namespace diminish

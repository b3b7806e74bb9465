#pragma once

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace diminish {

/// Images take memory only where they are written: for pipelines, which keep theirs. By itself
/// glibc would raise the threshold to the largest image that was freed; then images are made where
/// others were, and cleared.
inline void heap_for_pipelines() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 17);
#endif
}

/// Freed images are kept for the next ones: for commands that make and drop dozens a frame, where
/// fresh pages would take three quarters of the time.
inline void heap_for_scoring() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 25);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
#endif
}

}  // namespace diminish

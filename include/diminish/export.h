#pragma once

/// What programs may use of the library; all else is hidden in it.
#if defined(__GNUC__)
#define DIMINISH_EXPORT __attribute__((visibility("default")))
#else
#define DIMINISH_EXPORT
#endif

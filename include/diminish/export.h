#pragma once

/// Marks what programs may use of the library. Everything else is hidden.
#if defined(__GNUC__)
#define DIMINISH_EXPORT __attribute__((visibility("default")))
#else
#define DIMINISH_EXPORT
#endif

#pragma once

#include <cstddef>

namespace diminish {

/// What the process allocated, in all threads and libraries.
struct Allocations {
  std::size_t count = 0;
  std::size_t bytes = 0;
};

/// Whether this build counts: with the GNU C library, and not where a sanitizer replaces malloc.
bool allocations_are_counted();

/// Since the process began.
Allocations allocations();

}  // namespace diminish

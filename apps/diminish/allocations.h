#pragma once

#include <cstddef>

namespace diminish {

/// What the process allocated since it began, in all threads and libraries.
struct Allocations {
  std::size_t count = 0;
  std::size_t bytes = 0;
};

/// Null unless this build counts them: one with benchmarks does (bench/allocation_counter.cpp).
inline Allocations (*count_allocations)() = nullptr;

}  // namespace diminish

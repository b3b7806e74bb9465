#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace diminish {

/// The upper one of two medians (core/robust.h) of values that are not negative, of which there
/// must be one at least; changes the values. It counts them by their first bits, so that few are
/// left to compare: comparisons that come out either way cost most.
inline float median_of_magnitudes(std::vector<float>& values) {
  constexpr int bits = 11;                         // of 31: the exponent, and three of the mantissa
  constexpr std::int32_t least = (127 - 40) << 3;  // 2^-40; the greatest are those from 2^24 on
  constexpr std::int32_t buckets = 512;
  const auto bucket_of = [](float value) {
    const std::uint32_t first_bits = std::bit_cast<std::uint32_t>(value) << 1 >> (32 - bits);
    const auto bucket = std::clamp(static_cast<std::int32_t>(first_bits) - least, 0, buckets - 1);
    return static_cast<std::uint32_t>(bucket);
  };
  std::array<std::uint32_t, buckets> counts{};
  for (const float value : values) ++counts[bucket_of(value)];
  std::size_t middle = values.size() / 2;
  std::uint32_t bucket = 0;
  for (; middle >= counts[bucket]; ++bucket) middle -= counts[bucket];
  std::size_t count = 0;
  for (const float value : values) {
    values[count] = value;
    count += bucket_of(value) == bucket ? 1 : 0;
  }
  const auto found = values.begin() + static_cast<std::ptrdiff_t>(middle);
  std::nth_element(values.begin(), found, values.begin() + static_cast<std::ptrdiff_t>(count));
  return *found;
}

}  // namespace diminish

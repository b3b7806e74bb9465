#pragma once

namespace diminish {

/// Of any point or translation that a file or a program tells, in metres. Beyond it, numbers are
/// mistakes, and some overflow on the way.
inline constexpr double largest_coordinate_m = 1000;

}  // namespace diminish

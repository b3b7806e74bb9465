#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cstddef>

namespace diminish {

/// A bar on a terminal, nothing elsewhere.
inline void show_progress(std::size_t done, std::size_t total) {
  if (isatty(STDERR_FILENO) == 0) return;
  constexpr std::size_t width = 40;
  const std::size_t filled = total > 0 ? width * done / total : 0;
  fmt::print(stderr, "\r[{:=<{}}{: <{}}] {}/{}{}", "", filled, "", width - filled, done, total,
             done == total ? "\n" : "");
}

}  // namespace diminish

#pragma once

#include <cstddef>

#include "core/shared_tasks.h"
#include "core/tracing.h"

namespace diminish {

// Where a frame forks and joins.

/// Calls visit(i) for each i below `count`; whichever thread is free takes the next.
template <class Visit>
void for_tasks(std::size_t count, const Visit& visit) {
  if (count == 1) return visit(std::size_t{0});
  tracing::Region region(count);
  const auto work = [&](std::size_t i) {
    const tracing::Region::Task task(region, i);
    visit(i);
  };
  share_tasks(
      count,
      [](const void* what, std::size_t i) { (*static_cast<const decltype(work)*>(what))(i); },
      &work);
}

/// Does all works, at the same time if threads are free.
template <class... Works>
void do_all(const Works&... works) {
  for_tasks(sizeof...(works), [&](std::size_t i) {
    std::size_t k = 0;
    ((k++ == i ? works() : void()), ...);
  });
}

}  // namespace diminish

#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <cstddef>

#include "core/happens_before.h"
#include "core/tracing.h"

namespace diminish {

// Where a frame forks and joins: all threads of the caller's arena share the tasks.

/// Calls visit(i) for each i below `count`; whichever thread is free takes the next.
template <class Visit>
void for_tasks(std::size_t count, const Visit& visit) {
  if (count == 1) return visit(std::size_t{0});
  tracing::Region region(count);
  const char forked = 0;
  const char joined = 0;
  const auto work = [&](std::size_t i) DIMINISH_UNSANITIZED_THREADS {
    happens_after(&forked);
    {
      const tracing::Region::Task task(region, i);
      visit(i);
    }
    happens_before(&joined);
  };
  happens_before(&forked);
  oneapi::tbb::parallel_for(std::size_t{0}, count, work, oneapi::tbb::simple_partitioner());
  happens_after(&joined);
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

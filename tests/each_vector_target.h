#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

namespace diminish::testing {

/// Calls `work` once for each instruction set that the kernels were compiled for and this CPU has,
/// with the kernels on it. What Highway falls back to on other CPUs is among them: on x86-64 plain
/// C++ in Debian 12, SSE2 with newer Highways.
template <class Work>
void on_each_vector_target(Work&& work) {
  struct Restore {
    ~Restore() { hwy::SetSupportedTargetsForTest(0); }
  } restore;
  std::int64_t remaining = hwy::SupportedTargets() & HWY_TARGETS;
  ASSERT_NE(remaining & HWY_STATIC_TARGET, 0) << "what every CPU has is compiled, too";
  for (; remaining != 0; remaining &= remaining - 1) {
    const std::int64_t target = remaining & -remaining;
    hwy::SetSupportedTargetsForTest(target);
    SCOPED_TRACE(hwy::TargetName(target));
    work();
  }
}

}  // namespace diminish::testing

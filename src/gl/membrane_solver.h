#pragma once

#include <memory>

#include "gl/buffer.h"
#include "gl/context.h"
#include "membrane/solver.h"

namespace diminish::gl {

/// MembraneSolver whose equations are solved on the GPU: conjugate gradients, preconditioned by a
/// multigrid V-cycle, a fixed number of iterations without looking back.
class GpuMembraneSolver : public MembraneSolver {
 public:
  /// Throws Error where there is no driver that can do it.
  GpuMembraneSolver();
  ~GpuMembraneSolver() override;

  /// Throws Error where the GPU fails. tolerance: is not asked for.
  void solve(float tolerance) override;
  void read_block(int y, int column, float* result) const override;

 private:
  struct Resources;

  void pack();
  void run();

  Context context_;
  std::unique_ptr<Resources> resources_;
};

}  // namespace diminish::gl

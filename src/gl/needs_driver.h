#pragma once

#include <gtest/gtest.h>

#include "diminish/error.h"
#include "gl/context.h"

namespace diminish::gl {

/// Tests that are skipped where there is no driver with OpenGL 4.5, not even a software one.
class NeedsDriver : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      const Context context;
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
  }
};

}  // namespace diminish::gl

#include "gl/own_thread.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>
#include <vector>

namespace diminish::gl {
namespace {

TEST(GlOwnThread, DoesAllWorkInOneThreadThatIsNotTheCallers) {
  OwnThread own;
  std::vector<std::thread::id> ids;
  for (int i = 0; i < 3; ++i) {
    std::thread([&] { own.run([&] { ids.push_back(std::this_thread::get_id()); }); }).join();
  }
  own.run([&] {
    // Work that asks for more work does not wait for itself.
    own.run([&] { ids.push_back(std::this_thread::get_id()); });
  });
  ASSERT_EQ(ids.size(), 4U);
  for (const std::thread::id id : ids) EXPECT_EQ(id, ids[0]);
  EXPECT_NE(ids[0], std::this_thread::get_id());
}

TEST(GlOwnThread, ThrowsToTheCallerAndGoesOn) {
  OwnThread own;
  EXPECT_THROW(own.run([] { throw std::runtime_error("a test"); }), std::runtime_error);
  int done = 0;
  own.run([&] { ++done; });
  EXPECT_EQ(done, 1);
}

TEST(GlOwnThread, ManyCallersWaitForTheirOwnWork) {
  OwnThread own;
  int count = 0;  // changed in one thread only
  std::vector<std::thread> callers;
  callers.reserve(4);
  for (int i = 0; i < 4; ++i) {
    callers.emplace_back([&] {
      for (int k = 0; k < 500; ++k) {
        int before = -1;
        int after = -1;
        own.run([&] {
          before = count++;
          after = count;
        });
        ASSERT_EQ(after, before + 1);
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(count, 2000);
}

}  // namespace
}  // namespace diminish::gl

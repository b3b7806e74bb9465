#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>

#include <new>

int main(int argc, char** argv) {
  ::testing::InitGoogleMock(&argc, argv);
  oneapi::tbb::task_scheduler_handle workers{oneapi::tbb::attach{}};
  const int result = RUN_ALL_TESTS();
  // Threads that end only after main() may meet what is gone by then.
  oneapi::tbb::finalize(workers, std::nothrow);
  return result;
}

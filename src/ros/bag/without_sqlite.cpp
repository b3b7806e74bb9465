#include "diminish/error.h"
#include "ros/bag/bag.h"

namespace diminish::ros {

std::unique_ptr<BagReader> open_sqlite_bag(const std::filesystem::path&) {
  throw Error("this build is without SQLite, which a ROS 2 bag needs");
}

}  // namespace diminish::ros

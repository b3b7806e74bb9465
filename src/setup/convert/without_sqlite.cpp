#include "diminish/error.h"
#include "setup/convert/bag_writer.h"

namespace diminish {

std::unique_ptr<BagWriter> make_sqlite_bag(const std::filesystem::path& bag) {
  throw Error(bag.string() +
              ": this build is without SQLite, which a ROS 2 bag needs; FILE.mcap does not");
}

}  // namespace diminish

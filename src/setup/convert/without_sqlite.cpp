#include "diminish/error.h"
#include "setup/convert/convert.h"

namespace diminish {

Conversion convert_to_bag(const std::filesystem::path&, const std::filesystem::path& bag) {
  throw Error(bag.string() + ": this build is without SQLite, which a ROS 2 bag needs");
}

}  // namespace diminish

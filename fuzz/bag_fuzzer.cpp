#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "diminish/error.h"
#include "ros/bag/bag.h"
#include "setup/convert/bag_images.h"

using namespace diminish;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  for (const auto open : {ros::open_ros1_bag, ros::open_mcap}) {
    try {
      const auto bag = open(std::make_unique<std::istringstream>(bytes));
      for (ros::BagMessage message; bag->next(message);) read_bag_image(message);
    } catch (const Error&) {
    }
  }
  return 0;
}

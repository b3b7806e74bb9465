#include "setup/convert/message_definitions.h"

#include <array>
#include <string_view>
#include <utility>

namespace diminish {
namespace {

/// Fields in the order of ros/messages.cpp, which the tests hold to another implementation's.
constexpr std::array<std::pair<std::string_view, std::string_view>, 11> fields = {{
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    {"sensor_msgs/Image",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
     "uint32 step\nuint8[] data\n"},
    {"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
    {"sensor_msgs/RegionOfInterest",
     "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"},
    {"sensor_msgs/CameraInfo",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
     "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
     "sensor_msgs/RegionOfInterest roi\n"},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    {"geometry_msgs/Transform",
     "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    {"geometry_msgs/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
}};

std::string_view fields_of(std::string_view name) {
  for (const auto& [type, text] : fields) {
    if (type == name) return text;
  }
  return "";
}

/// Adds the types that `text` uses and that are not in `done` yet.
void add_used(std::string_view text, std::string& done) {
  for (const auto& [type, own] : fields) {
    const bool is_used = text.find(std::string(type) + " ") != std::string_view::npos ||
                         text.find(std::string(type) + "[") != std::string_view::npos;
    const std::string title = "MSG: " + std::string(type) + "\n";
    if (!is_used || done.find(title) != std::string::npos) continue;
    done += std::string(80, '=') + "\n" + title + std::string(own);
    add_used(own, done);
  }
}

}  // namespace

std::string message_definition(const std::string& type) {
  // "sensor_msgs/msg/Image" is "sensor_msgs/Image" in ROS's language.
  std::string name = type;
  const std::size_t middle = name.find("/msg/");
  if (middle != std::string::npos) name.erase(middle, 4);
  std::string text(fields_of(name));
  std::string used;
  add_used(text, used);
  return text + used;
}

}  // namespace diminish

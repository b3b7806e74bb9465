#include "diminish/camera_source.h"

namespace diminish {
namespace {

const bool left_out = Registry<CameraSource>::leave_out("ros2", "Fast DDS");

}  // namespace
}  // namespace diminish

#include "diminish/camera_source.h"

namespace diminish {
namespace {

const bool left_out = Registry<CameraSource>::leave_out("openni2", "OpenNI2");

}  // namespace
}  // namespace diminish

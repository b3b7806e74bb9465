#include "diminish/camera_source.h"

namespace diminish {
namespace {

const bool left_out = Registry<CameraSource>::leave_out("gst", "GStreamer");

}  // namespace
}  // namespace diminish

#include "diminish/pose_source.h"

namespace diminish {
namespace {

const bool left_out = Registry<PoseSource>::leave_out("tf", "Fast DDS");

}  // namespace
}  // namespace diminish

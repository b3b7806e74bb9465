#include "diminish/reconstructor.h"

namespace diminish {
namespace {

// What a build without OpenGL says of the methods of this folder.
const bool left_out = Registry<Reconstructor>::leave_out("gl", "libepoxy and EGL");
const bool geometry_left_out =
    Registry<Reconstructor>::leave_out("gl_geometry", "libepoxy and EGL");

}  // namespace
}  // namespace diminish

#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "bindings.h"
#include "diminish/diminished_frame.h"
#include "diminish/frame_source.h"

namespace diminish::python {

/// A frame that was processed.
struct Frame {
  std::shared_ptr<const void> owner;  ///< of the two
  const FrameSet* input;
  const DiminishedFrame* result;
};
using SharedFrame = std::shared_ptr<Frame>;

void add_frame(py::module_& module);

/// A folder with rig.yaml and scene.yaml. detector: replaces the scene's objects by what it finds;
/// pose_source: replaces the rig's; empty: does not. Throws Error.
Recording load_setup(const std::filesystem::path& folder, const std::string& detector,
                     const std::string& pose_source);

/// `options`, or the defaults for None, with some of them set.
Options chosen_options(const py::object& options, const py::kwargs& values);

}  // namespace diminish::python

#include "diminish/pipeline.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "diminish/frame_source.h"
#include "frame.h"

namespace diminish::python {
namespace {

/// What is processed, and its result.
struct OwnFrame {
  FrameSet input;
  DiminishedFrame result;
};

SharedFrame share(const std::shared_ptr<OwnFrame>& frame) {
  return std::make_shared<Frame>(Frame{frame, &frame->input, &frame->result});
}

/// A set-up's pipeline.
class PythonPipeline {
 public:
  PythonPipeline(const std::filesystem::path& folder, const Options& options,
                 const std::string& detector, const std::string& pose_source)
      : recording_(load_setup(folder, detector, pose_source)), options_(options) {
    pipeline_ = std::make_unique<Pipeline>(recording_.rig, recording_.scene, options_);
    pipeline_->want_reconstruction(false);
  }

  SharedFrame process(const Bytes& color,
                      const std::map<std::string, std::pair<Bytes, Depths>>& rgbd, double stamp_s) {
    auto frame = std::make_shared<OwnFrame>();
    FrameSet& input = frame->input;
    input.index = frames_++;
    input.name = std::to_string(input.index);
    input.stamp_s = stamp_s;
    copy(as_picture(color, "color"), input.color.own());
    for (const RgbdCamera& camera : recording_.rig.rgbd) {
      RgbdFrame& images = input.rgbd.emplace_back();
      const auto given = rgbd.find(camera.name);
      if (given == rgbd.end()) {
        images.missing = camera.name + ": no images given";
        continue;
      }
      copy(as_picture(given->second.first, camera.name.c_str()), images.color.own());
      copy(as_depth(given->second.second, camera.name.c_str()), images.depth.own());
      images.color_stamp_s = images.depth_stamp_s = stamp_s;
    }
    for (const auto& [name, images] : rgbd) {
      const auto& cameras = recording_.rig.rgbd;
      if (std::none_of(cameras.begin(), cameras.end(),
                       [&name = name](const RgbdCamera& camera) { return camera.name == name; })) {
        throw py::key_error("rgbd: the rig has no camera '" + name + "'");
      }
    }
    const py::gil_scoped_release release;
    pipeline_->process(input, frame->result);
    return share(frame);
  }

  /// Null at the end.
  SharedFrame next(FrameSource& source) {
    auto frame = std::make_shared<OwnFrame>();
    if (!source.next(frame->input)) return nullptr;
    pipeline_->process(frame->input, frame->result);
    return share(frame);
  }

  std::unique_ptr<FrameSource> open() const { return open_recording(recording_, options_); }
  std::vector<std::string> cameras() const {
    std::vector<std::string> names;
    for (const RgbdCamera& camera : recording_.rig.rgbd) names.push_back(camera.name);
    return names;
  }
  void forget() { pipeline_->forget(); }

 private:
  Recording recording_;
  Options options_;
  std::unique_ptr<Pipeline> pipeline_;
  std::size_t frames_ = 0;
};

/// The frames of a set-up's recording.
struct Frames {
  std::shared_ptr<PythonPipeline> pipeline;
  std::unique_ptr<FrameSource> source;

  SharedFrame next() {
    SharedFrame frame;
    {
      const py::gil_scoped_release release;
      frame = pipeline->next(*source);
    }
    if (!frame) throw py::stop_iteration();
    return frame;
  }
};

}  // namespace

void add_pipeline(py::module_& module) {
  py::class_<Frames>(module, "Frames", "The frames of a recording, one after the other")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &Frames::next);
  py::class_<PythonPipeline, std::shared_ptr<PythonPipeline>>(
      module, "Pipeline",
      "The pipeline of a set-up: a folder with rig.yaml and scene.yaml. If it is a recording, "
      "iterating gives its frames:\n\n"
      "    for frame in diminish.Pipeline('recording', memory='off'):\n"
      "        cv2.imshow('diminished', frame.picture)\n\n"
      "detector: removes what it finds, such as 'difference', instead of the objects in "
      "scene.yaml. pose_source: finds the cameras' poses instead of rig.yaml's. "
      "Further arguments: Options, or single options.")
      .def(py::init([](const std::filesystem::path& folder, const py::object& options,
                       const std::string& detector, const std::string& pose_source,
                       const py::kwargs& values) {
             return std::make_shared<PythonPipeline>(folder, chosen_options(options, values),
                                                     detector, pose_source);
           }),
           py::arg("folder"), py::arg("options") = py::none(), py::arg("detector") = "",
           py::arg("pose_source") = "")
      .def("__iter__",
           [](const std::shared_ptr<PythonPipeline>& self) {
             return Frames{self, self->open()};
           })
      .def("process", &PythonPipeline::process, py::arg("color"),
           py::arg("rgbd") = std::map<std::string, std::pair<Bytes, Depths>>{},
           py::arg("stamp_s") = 0.0,
           "Processes images of your own. color: height x width x 3, uint8, BGR. rgbd: by the "
           "camera's name, (color, depth), depth height x width, uint16, in the rig's unit. "
           "stamp_s: with memory, times that grow.")
      .def("forget", &PythonPipeline::forget, "Forgets what was seen in earlier frames")
      .def_property_readonly("cameras", &PythonPipeline::cameras, "The RGB-D cameras' names");
}

}  // namespace diminish::python

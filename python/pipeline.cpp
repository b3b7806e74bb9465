#include "diminish/pipeline.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "diminish/frame_source.h"
#include "diminish/stage.h"

namespace diminish::python {
namespace {

/// A frame that was processed, with what it was made of. Shared with the arrays that view it.
struct Frame {
  FrameSet input;
  DiminishedFrame result;
};
using SharedFrame = std::shared_ptr<Frame>;

/// A set-up's pipeline.
class PythonPipeline {
 public:
  PythonPipeline(const std::filesystem::path& folder, const Options& options,
                 const std::string& detector)
      : recording_(load_recording(folder)) {
    if (!detector.empty()) {
      const Config object = Config::parse(
          "occluders:\n  - name: object\n    detector: \"" + detector + "\"", "detector");
      recording_.scene.occluders = read_scene(object).occluders;
    }
    options_ = options;
    pipeline_ = std::make_unique<Pipeline>(recording_.rig, recording_.scene, options_);
    pipeline_->want_reconstruction(false);
  }

  SharedFrame process(const Bytes& color,
                      const std::map<std::string, std::pair<Bytes, Depths>>& rgbd, double stamp_s) {
    auto frame = std::make_shared<Frame>();
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
    return frame;
  }

  /// Null at the end.
  SharedFrame next(FrameSource& source) {
    auto frame = std::make_shared<Frame>();
    if (!source.next(frame->input)) return nullptr;
    pipeline_->process(frame->input, frame->result);
    return frame;
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

py::dict report_of(const Frame& frame) {
  const FrameReport& report = frame.result.report;
  py::dict stages;
  for (std::size_t i = 0; i < stage_count; ++i) stages[stage_names[i]] = report.milliseconds[i];
  py::list objects;
  for (const OccluderReport& object : report.occluders) {
    objects.append(py::dict(py::arg("name") = object.name, py::arg("in_color") = object.in_color,
                            py::arg("in_rgbd") = object.in_rgbd,
                            py::arg("message") = object.message));
  }
  return py::dict(py::arg("objects") = objects, py::arg("mask_pixels") = report.mask_pixels,
                  py::arg("seen_pixels") = report.valid_pixels - report.remembered_pixels,
                  py::arg("remembered_pixels") = report.remembered_pixels,
                  py::arg("invented_pixels") = report.missing_pixels,
                  py::arg("milliseconds") = stages, py::arg("frame_ms") = report.frame_ms,
                  py::arg("skipped") = report.skipped, py::arg("faults") = report.faults,
                  py::arg("messages") = report.messages);
}

py::bytes as_png(const Frame& frame) {
  const Image<Bgr>& picture = frame.result.picture;
  if (picture.empty()) return {};
  const cv::Mat pixels(picture.height(), picture.width(), CV_8UC3,
                       const_cast<Bgr*>(picture.data()));
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", pixels, bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void add_frame(py::module_& module) {
  py::class_<Frame, SharedFrame>(module, "Frame",
                                 "A frame without the objects. Its arrays are read-only views.")
      .def_property_readonly(
          "name", [](const Frame& frame) { return frame.result.name; },
          "The colour image's file name without its extension")
      .def_property_readonly("index", [](const Frame& frame) { return frame.result.index; })
      .def_property_readonly("stamp_s", [](const Frame& frame) { return frame.result.stamp_s; })
      .def_property_readonly(
          "picture", [](const SharedFrame& frame) { return view_of(frame->result.picture, frame); },
          "The user's view without the objects: height x width x 3, uint8, BGR")
      .def_property_readonly(
          "mask", [](const SharedFrame& frame) { return view_of(frame->result.mask, frame); },
          "255 where pixels were replaced: height x width, uint8")
      .def_property_readonly(
          "provenance",
          [](const SharedFrame& frame) { return view_of(frame->result.provenance, frame); },
          "Where each pixel comes from: 0 the camera; 1 to 199 an RGB-D camera; 200 witnessed, 201 "
          "remembered; 254 invented; 255 unknown")
      .def_property_readonly(
          "input",
          [](const SharedFrame& frame) { return view_of(frame->input.color.view(), frame); },
          "The user's view as the camera saw it")
      .def_property_readonly(
          "rgbd",
          [](const SharedFrame& frame) {
            py::list cameras;
            for (const RgbdFrame& images : frame->input.rgbd) {
              if (!images.available()) {
                cameras.append(py::none());
                continue;
              }
              cameras.append(py::make_tuple(view_of(images.color.view(), frame),
                                            view_of(images.depth.view(), frame)));
            }
            return cameras;
          },
          "(color, depth) of each RGB-D camera; None where there were no images")
      .def_property_readonly("report", &report_of, "What was found, counted, measured and missed")
      .def("_repr_png_", &as_png);
}

}  // namespace

void add_pipeline(py::module_& module) {
  add_frame(module);
  py::class_<Frames>(module, "Frames")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &Frames::next);
  py::class_<PythonPipeline, std::shared_ptr<PythonPipeline>>(
      module, "Pipeline",
      "The pipeline of a set-up: a folder with rig.yaml and scene.yaml. If it is a recording, "
      "iterating gives its frames:\n\n"
      "    for frame in diminish.Pipeline('recording', memory='off'):\n"
      "        cv2.imshow('diminished', frame.picture)\n\n"
      "detector: removes what it finds, such as 'difference', instead of the objects in "
      "scene.yaml. "
      "Further arguments: Options, or single options.")
      .def(py::init([](const std::filesystem::path& folder, const py::object& options,
                       const std::string& detector, const py::kwargs& values) {
             Options chosen = options.is_none() ? Options{} : options.cast<Options>();
             const py::object self = py::cast(&chosen, py::return_value_policy::reference);
             for (const auto& [name, value] : values) py::setattr(self, name, value);
             return std::make_shared<PythonPipeline>(folder, chosen, detector);
           }),
           py::arg("folder"), py::arg("options") = py::none(), py::arg("detector") = "")
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

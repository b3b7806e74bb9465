#include "frame.h"

#include <pybind11/stl.h>

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "diminish/objects_of_detector.h"
#include "diminish/stage.h"

namespace diminish::python {
namespace {

py::dict report_of(const Frame& frame) {
  const FrameReport& report = frame.result->report;
  py::dict stages;
  for (std::size_t i = 0; i < stage_count; ++i) stages[stage_names[i]] = report.milliseconds[i];
  py::list objects;
  for (const OccluderReport& object : report.occluders) {
    objects.append(py::dict(py::arg("name") = object.name, py::arg("in_color") = object.in_color,
                            py::arg("in_rgbd") = object.in_rgbd,
                            py::arg("message") = object.message));
  }
  return py::dict(py::arg("objects") = objects, py::arg("mask_pixels") = report.mask_pixels,
                  py::arg("seen_pixels") =
                      report.valid_pixels - report.remembered_pixels - report.estimated_pixels,
                  py::arg("remembered_pixels") = report.remembered_pixels,
                  py::arg("estimated_pixels") = report.estimated_pixels,
                  py::arg("invented_pixels") = report.missing_pixels, py::arg("fit") = report.fit,
                  py::arg("in_doubt") = report.in_doubt, py::arg("milliseconds") = stages,
                  py::arg("frame_ms") = report.frame_ms, py::arg("skipped") = report.skipped,
                  py::arg("faults") = report.faults, py::arg("messages") = report.messages);
}

py::bytes as_png(const Frame& frame) {
  const Image<Bgr>& picture = frame.result->picture;
  if (picture.empty()) return {};
  const cv::Mat pixels(picture.height(), picture.width(), CV_8UC3,
                       const_cast<Bgr*>(picture.data()));
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", pixels, bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Recording load_setup(const std::filesystem::path& folder, const std::string& detector,
                     const std::string& pose_source) {
  Recording setup = load_recording(folder);
  if (!detector.empty()) {
    setup.scene.occluders = objects_of_detector(detector, "detector");
  }
  if (!pose_source.empty()) {
    setup.rig.pose_source = pose_source;
    setup.rig.pose = {};
  }
  return setup;
}

Options chosen_options(const py::object& options, const py::kwargs& values) {
  Options chosen = options.is_none() ? Options{} : options.cast<Options>();
  const py::object self = py::cast(&chosen, py::return_value_policy::reference);
  for (const auto& [name, value] : values) py::setattr(self, name, value);
  return chosen;
}

void add_frame(py::module_& module) {
  py::class_<Frame, SharedFrame>(module, "Frame",
                                 "A frame without the objects. Its arrays are read-only views.")
      .def_property_readonly(
          "name", [](const Frame& frame) { return frame.result->name; },
          "The colour image's file name without its extension")
      .def_property_readonly("index", [](const Frame& frame) { return frame.result->index; })
      .def_property_readonly("stamp_s", [](const Frame& frame) { return frame.result->stamp_s; })
      .def_property_readonly(
          "picture",
          [](const SharedFrame& frame) { return view_of(frame->result->picture, frame); },
          "The user's view without the objects: height x width x 3, uint8, BGR")
      .def_property_readonly(
          "mask", [](const SharedFrame& frame) { return view_of(frame->result->mask, frame); },
          "255 where pixels were replaced: height x width, uint8")
      .def_property_readonly(
          "provenance",
          [](const SharedFrame& frame) { return view_of(frame->result->provenance, frame); },
          "Where each pixel comes from: 0 the camera; 1 to 199 an RGB-D camera; 200 witnessed, 201 "
          "remembered, 202 part of a bar without depth; 254 invented; 255 unknown")
      .def_property_readonly(
          "input",
          [](const SharedFrame& frame) { return view_of(frame->input->color.view(), frame); },
          "The user's view as the camera saw it")
      .def_property_readonly(
          "rgbd",
          [](const SharedFrame& frame) {
            py::list cameras;
            for (const RgbdFrame& images : frame->input->rgbd) {
              if (!images.has_picture()) {
                cameras.append(py::none());
                continue;
              }
              py::object depth = py::none();
              if (!images.depth.empty()) depth = view_of(images.depth.view(), frame);
              cameras.append(py::make_tuple(view_of(images.color.view(), frame), depth));
            }
            return cameras;
          },
          "(color, depth) of each RGB-D camera; None where there were no images, and for a depth "
          "that "
          "is estimated")
      .def_property_readonly("report", &report_of, "What was found, counted, measured and missed")
      .def("_repr_png_", &as_png);
}
}  // namespace diminish::python

#include <pybind11/stl.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "diminish/inpainter.h"
#include "diminish/occluder_detector.h"
#include "diminish/pose_source.h"

namespace diminish::python {
namespace {

/// A Python callable, for the life of the process: methods stay registered after the interpreter
/// has ended.
py::handle keep(const py::object& callable) {
  return callable.inc_ref();
}

using Callable = std::shared_ptr<py::object>;

/// What a pipeline calls: of a class, an object of its own. Any thread may make it and let it go.
Callable made_of(py::handle callable) {
  const py::gil_scoped_acquire acquire;
  const bool is_class = PyType_Check(callable.ptr()) != 0;
  return {new py::object(is_class ? callable() : py::reinterpret_borrow<py::object>(callable)),
          [](py::object* object) {
            const py::gil_scoped_acquire acquire_again;
            delete object;
          }};
}

/// A copy, which the callee may keep and change.
template <class Pixel>
py::array copy_of(const ImageView<Pixel>& image) {
  const auto owner = std::make_shared<Image<Pixel>>();
  copy(image, *owner);
  return view_of(ImageView<Pixel>(*owner), owner).attr("copy")().template cast<py::array>();
}

/// (color, depth) of each RGB-D camera, None where there are no images.
py::list copies_of(const std::vector<RgbdFrame>& cameras) {
  py::list list;
  for (const RgbdFrame& images : cameras) {
    if (images.available()) {
      list.append(py::make_tuple(copy_of(images.color.view()), copy_of(images.depth.view())));
    } else {
      list.append(py::none());
    }
  }
  return list;
}

bool add_mask(const py::object& given, const std::string& name, Mask& mask) {
  if (given.is_none()) return false;
  const auto array = given.cast<Bytes>();
  const ImageView<std::uint8_t> view = as_mask(array, name.c_str());
  if (view.bounds() != mask.bounds()) {
    throw py::value_error(name + ": expected a mask of " + std::to_string(mask.height()) + " x " +
                          std::to_string(mask.width()) + ", got " + std::to_string(view.height()) +
                          " x " + std::to_string(view.width()));
  }
  bool any = false;
  for (int y = 0; y < mask.height(); ++y) {
    std::transform(view.row(y), view.row(y) + view.width(), mask.row(y), mask.row(y),
                   [&any](std::uint8_t from, std::uint8_t to) -> std::uint8_t {
                     any = any || from != 0;
                     return from != 0 ? 255 : to;
                   });
  }
  return any;
}

class PythonDetector : public OccluderDetector {
 public:
  PythonDetector(std::string name, Callable callable)
      : name_(std::move(name)), callable_(std::move(callable)) {}

  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override {
    const py::gil_scoped_acquire acquire;
    OccluderReport report;
    report.name = name_;
    report.in_rgbd.assign(observation.frame.rgbd.size(), false);
    const py::object found =
        (*callable_)(copy_of(observation.frame.color.view()), copies_of(observation.frame.rgbd));
    py::object in_color = found;
    if (py::isinstance<py::tuple>(found)) {
      const auto both = found.cast<std::pair<py::object, py::list>>();
      in_color = both.first;
      for (std::size_t k = 0; k < std::min(report.in_rgbd.size(), both.second.size()); ++k) {
        report.in_rgbd[k] = add_mask(both.second[k], name_, masks.rgbd_color[k]);
      }
    }
    report.in_color = add_mask(in_color, name_, masks.color);
    return report;
  }

 private:
  std::string name_;
  Callable callable_;
};

class PythonInpainter : public Inpainter {
 public:
  explicit PythonInpainter(Callable callable) : callable_(std::move(callable)) {}

  bool inpaint(const Holes& holes, const Options&, Image<Bgr>& picture) override {
    const py::gil_scoped_acquire acquire;
    const py::object result = (*callable_)(copy_of(ImageView<Bgr>(picture)),
                                           copy_of(ImageView<std::uint8_t>(holes.missing)));
    const auto array = result.cast<Bytes>();
    const ImageView<Bgr> filled = as_picture(array, "inpainter");
    if (filled.bounds() != picture.bounds()) {
      throw py::value_error("inpainter: expected the picture's size back");
    }
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        if (holes.missing(x, y) != 0) picture(x, y) = filled(x, y);
      }
    }
    return true;
  }

 private:
  Callable callable_;
};

using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// name: of what was given, for messages.
RigidTransform as_rigid_transform(const Matrix& array, const std::string& name) {
  if (array.ndim() != 2 || array.shape(0) < 3 || array.shape(0) > 4 || array.shape(1) != 4) {
    throw py::value_error(name + ": expected a matrix of 3 x 4 or 4 x 4");
  }
  using RowMajor = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor> matrix(array.data());
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  constexpr double single_precision = 1e-4;
  bool is_rigid = matrix.allFinite() && rotation.determinant() > 0 &&
                  (rotation * rotation.transpose()).isIdentity(single_precision);
  if (array.shape(0) == 4) {
    const Eigen::Map<const Eigen::RowVector4d> last(array.data() + 12);
    is_rigid = is_rigid && last == Eigen::RowVector4d(0, 0, 0, 1);
  }
  if (!is_rigid) {
    throw py::value_error(name +
                          ": expected a rotation and a translation; in a fourth row 0 0 0 1");
  }
  return {Eigen::Quaterniond(rotation).normalized().toRotationMatrix(), matrix.col(3)};
}

class PythonPoseSource : public PoseSource {
 public:
  PythonPoseSource(const Rig& rig, Callable callable) : callable_(std::move(callable)) {
    for (const RgbdCamera& camera : rig.rgbd) names_.push_back(camera.name);
  }

  bool needs_markers() const override { return false; }

  void estimate(const FrameSet& frame, const Markers&, Poses& poses) override {
    const py::gil_scoped_acquire acquire;
    const py::object found =
        (*callable_)(copy_of(frame.color.view()), copies_of(frame.rgbd), frame.stamp_s);
    if (found.is_none()) {
      poses.messages.emplace_back("the pose source found no poses");
      return;
    }
    for (const auto& [key, value] : found.cast<py::dict>()) {
      const auto name = key.cast<std::string>();
      pose_of(name, poses) = as_rigid_transform(value.cast<Matrix>(), name);
    }
  }

 private:
  /// The place for the pose of this name.
  std::optional<RigidTransform>& pose_of(const std::string& name, Poses& poses) const {
    if (name == "color_from_world") return poses.color_from_world;
    for (std::size_t k = 0; k < names_.size(); ++k) {
      if (name == names_[k] + "_depth_from_world") return poses.depth_from_world[k];
      if (name == "color_from_" + names_[k] + "_depth") return poses.color_from_depth[k];
    }
    throw py::value_error(
        "pose source: expected color_from_world, NAME_depth_from_world or "
        "color_from_NAME_depth, NAME being one of the rig's cameras; got '" +
        name + "'");
  }

  std::vector<std::string> names_;
  Callable callable_;
};

void expect_free(bool was_free, const std::string& kind, const std::string& name) {
  if (!was_free) throw py::value_error(kind + " '" + name + "': the name is taken");
}

py::object add_detector(const std::string& name, const py::object& callable) {
  const py::handle kept = keep(callable);
  const OccluderDetector::Entry entry{.read =
                                          [](const Config& place) {
                                            place.expect_keys({"name", "detector"});
                                            return std::make_shared<OccluderSettings>();
                                          },
                                      .make =
                                          [kept](const OccluderSpec& spec, const Rig&) {
                                            return std::make_unique<PythonDetector>(spec.name,
                                                                                    made_of(kept));
                                          }};
  expect_free(Registry<OccluderDetector>::add(name, entry), "detector", name);
  return callable;
}

py::object add_inpainter(const std::string& name, const py::object& callable) {
  const py::handle kept = keep(callable);
  expect_free(Registry<Inpainter>::add(
                  name, [kept] { return std::make_unique<PythonInpainter>(made_of(kept)); }),
              "inpainter", name);
  return callable;
}

py::object add_pose_source(const std::string& name, const py::object& callable) {
  const py::handle kept = keep(callable);
  expect_free(Registry<PoseSource>::add(name,
                                        [kept](const Rig& rig, const Scene&) {
                                          if (rig.pose.exists()) rig.pose.expect_keys({"source"});
                                          return std::make_unique<PythonPoseSource>(rig,
                                                                                    made_of(kept));
                                        }),
              "pose source", name);
  return callable;
}

/// Adds a decorator, NAME(METHOD'S NAME), that hands what it decorates to `add`.
template <class Add>
void add_decorator(py::module_& module, const char* name, Add add, const char* help) {
  module.def(
      name,
      [add](const std::string& method) {
        return py::cpp_function(
            [add, method](const py::object& callable) { return add(method, callable); });
      },
      py::arg("name"), help);
}

}  // namespace

void add_methods(py::module_& module) {
  add_decorator(
      module, "detector", add_detector,
      "A decorator: adds a detector, for `detector: NAME` in scene.yaml or "
      "Pipeline(detector=NAME).\n\n"
      "It is called with the user's picture and, for each RGB-D camera, (color, depth) or None. "
      "It\n"
      "returns the mask of what to remove, or (mask, [mask of each RGB-D camera's colour image]);\n"
      "None: nothing. Of a class, each pipeline makes an object and calls that.");
  add_decorator(
      module, "inpainter", add_inpainter,
      "A decorator: adds an inpainting method, for the option inpaint=NAME.\n\n"
      "It is called with the picture and the mask of the pixels to fill, and returns the picture.");
  add_decorator(
      module, "pose_source", add_pose_source,
      "A decorator: adds a pose source, for `pose: {source: NAME}` in rig.yaml or "
      "Pipeline(pose_source=NAME).\n\n"
      "It is called with what a detector gets and the time in seconds, and returns a dict of 3 x 4 "
      "or 4 x 4 matrices\n"
      "in metres, whose names say the frames: color_from_world, rgbd0_depth_from_world, or "
      "color_from_rgbd0_depth.\n"
      "What it leaves out is unknown; so is everything for None.");
}

}  // namespace diminish::python

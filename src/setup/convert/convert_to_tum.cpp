#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/mat.h"
#include "core/text.h"
#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "setup/convert/convert.h"
#include "setup/convert/tum_format.h"
#include "sink/partial_file.h"
#include "sink/recording_folder.h"
#include "source/find_camera.h"
#include "source/image_stream.h"

namespace diminish {
namespace {

/// The camera that the folder's images are of: the depth sensor, without its lens's distortion.
Intrinsics pinhole(Intrinsics lens) {
  lens.lens_model = LensModel::plumb_bob;
  lens.distortion = {};
  return lens;
}

/// Both sensors' pictures as that camera sees them.
class Registration {
 public:
  explicit Registration(const RgbdCamera& camera)
      : view_(pinhole(camera.depth)),
        color_lens_(camera.color),
        color_from_depth_(camera.color_from_depth),
        unit_m_(camera.depth_unit_m),
        is_needed_(!(camera.color == view_ && camera.depth == view_ &&
                     camera.color_from_depth.rotation.isIdentity(1e-9) &&
                     camera.color_from_depth.translation.isZero(1e-9))) {
    const Lens depth_lens(camera.depth);
    source_.create(view_.height, view_.width, CV_32FC2);
    for (int y = 0; y < view_.height; ++y) {
      for (int x = 0; x < view_.width; ++x) {
        const auto pixel = depth_lens.distort(ray(x, y));
        source_.at<cv::Vec2f>(y, x) =
            pixel ? cv::Vec2f(static_cast<float>(pixel->x()), static_cast<float>(pixel->y()))
                  : cv::Vec2f(-1e6F, -1e6F);
      }
    }
  }

  bool is_needed() const { return is_needed_; }
  const Intrinsics& view() const { return view_; }

  /// In the format's unit. No value is made up: each is the nearest pixel's.
  void take_depth(const cv::Mat& from, cv::Mat& to) const {
    cv::remap(from, to, source_, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT, 0);
    to.forEach<std::uint16_t>([this](std::uint16_t& value, const int*) {
      const double units = std::round(value * unit_m_ / tum_unit_m);
      value = units <= 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
    });
  }

  /// depth: as `take_depth` made it. Where nothing was measured, the surface before it in the row
  /// is taken to go on.
  void take_color(const cv::Mat& from, const cv::Mat& depth, cv::Mat& to) const {
    cv::Mat places(depth.size(), CV_32FC2);
    double depth_m = 1;
    for (int y = 0; y < depth.rows; ++y) {
      for (int x = 0; x < depth.cols; ++x) {
        const auto value = depth.at<std::uint16_t>(y, x);
        if (value != 0) depth_m = value * tum_unit_m;
        const Eigen::Vector3d point = Eigen::Vector3d(ray(x, y).homogeneous()) * depth_m;
        const auto pixel = color_lens_.project(color_from_depth_ * point);
        places.at<cv::Vec2f>(y, x) =
            pixel ? cv::Vec2f(static_cast<float>(pixel->x()), static_cast<float>(pixel->y()))
                  : cv::Vec2f(-1e6F, -1e6F);
      }
    }
    cv::remap(from, to, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  }

 private:
  Eigen::Vector2d ray(int x, int y) const {
    return {(x - view_.cx) / view_.fx, (y - view_.cy) / view_.fy};
  }

  Intrinsics view_;
  Lens color_lens_;
  RigidTransform color_from_depth_;
  double unit_m_;
  bool is_needed_;
  cv::Mat source_;  ///< of each pixel, its place in the depth image
};

/// A list of the folder, and its images.
class TumStream {
 public:
  TumStream(const std::filesystem::path& folder, const std::string& name, const char* title)
      : folder_(folder), name_(name), list_(folder / (name + ".txt")) {
    std::error_code ignored;
    std::filesystem::create_directories(folder / name, ignored);
    list_ << "# " << title << "\n# made by diminish convert\n# timestamp filename\n";
  }
  void add(double stamp_s, const cv::Mat& image) {
    const std::string file = name_of(stamp_s, ".png");
    if (!cv::imwrite((folder_ / file).string(), image)) fail();
    add_line(stamp_s, file);
  }
  void copy(double stamp_s, const std::filesystem::path& image) {
    const std::string file = name_of(stamp_s, image.extension().string());
    copy_to(image, folder_ / file);
    add_line(stamp_s, file);
  }
  std::size_t images() const { return images_; }

 private:
  std::string name_of(double stamp_s, const std::string& extension) const {
    return fmt::format("{}/{:.6f}{}", name_, stamp_s, extension);
  }
  void add_line(double stamp_s, const std::string& file) {
    list_ << fmt::format("{:.6f} {}\n", stamp_s, file) << std::flush;
    if (!list_) fail();
    ++images_;
  }
  [[noreturn]] void fail() const {
    throw Error(Error::io, (folder_ / name_).string() + ": cannot be written");
  }

  std::filesystem::path folder_;
  std::string name_;
  std::ofstream list_;
  std::size_t images_ = 0;
};

}  // namespace

Conversion convert_to_tum(const std::filesystem::path& recording,
                          const std::filesystem::path& folder, const std::string& name) {
  const Rig rig = load_rig(recording / "rig.yaml");
  const RgbdCamera* const camera = find_rgbd_camera(rig, name);
  if (!camera || !camera->measures_depth) {
    throw Error(fmt::format("{}: expected an RGB-D camera of the recording, got '{}'",
                            recording.string(), printable(name)));
  }
  make_recording_folder(folder);
  const Registration registration(*camera);
  ImageStream<Bgr> colors(recording / (name + "_color.txt"), camera->color);
  ImageStream<std::uint16_t> depths(recording / (name + "_depth.txt"), camera->depth);
  TumStream rgb(folder, "rgb", "color images");
  TumStream depth_out(folder, "depth", "depth maps");
  Conversion conversion;
  Image<Bgr> color;
  Image<std::uint16_t> depth;
  cv::Mat seen_depth, seen_color;
  const bool is_unit = std::abs(camera->depth_unit_m / tum_unit_m - 1) < 1e-9;
  for (std::size_t i = 0; i < depths.entries().size(); ++i) {
    const StreamEntry& entry = depths.entries()[i];
    if (!registration.is_needed() && is_unit && !entry.frame) {
      depth_out.copy(entry.stamp_s, recording / entry.file);
      continue;
    }
    depths.read(i, depth);
    registration.take_depth(as_mat(depth), seen_depth);
    depth_out.add(entry.stamp_s, seen_depth);
  }
  const double tolerance_s = median_period_s(colors.entries());
  for (std::size_t i = 0; i < colors.entries().size(); ++i) {
    const StreamEntry& entry = colors.entries()[i];
    if (!registration.is_needed() && !entry.frame) {
      rgb.copy(entry.stamp_s, recording / entry.file);
      continue;
    }
    const auto nearest = nearest_entry(depths.entries(), entry.stamp_s, tolerance_s);
    if (!nearest) {
      ++conversion.left_out;
      continue;
    }
    depths.read(*nearest, depth);
    registration.take_depth(as_mat(depth), seen_depth);
    colors.read(i, color);
    registration.take_color(as_mat(color), seen_depth, seen_color);
    rgb.add(entry.stamp_s, seen_color);
  }
  write_file(folder / "camera.txt", tum_camera_text(registration.view()));
  if (rig.pose_source == "file") {
    copy_to(rig.pose.at("files").at(name).path(), folder / "groundtruth.txt");
  }
  conversion.streams = {{"rgb", name + "_color", rgb.images()},
                        {"depth", name + "_depth", depth_out.images()}};
  return conversion;
}

}  // namespace diminish

#include "memory/scan_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "diminish/error.h"
#include "geometry/every.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

/// The camera that `add_behind` adds.
constexpr const char* behind = "behind";

/// Up to what a file's digits round.
bool are_alike(const Intrinsics& a, const Intrinsics& b) {
  constexpr double tolerance_px = 0.01;
  constexpr double tolerance = 1e-4;
  const auto near = [](double x, double y, double most) { return std::abs(x - y) <= most; };
  return a.width == b.width && a.height == b.height && a.lens_model == b.lens_model &&
         near(a.fx, b.fx, tolerance_px) && near(a.fy, b.fy, tolerance_px) &&
         near(a.cx, b.cx, tolerance_px) && near(a.cy, b.cy, tolerance_px) &&
         std::equal(a.distortion.begin(), a.distortion.end(), b.distortion.begin(),
                    [&](double x, double y) { return near(x, y, tolerance); });
}

/// An RGB-D camera's testimonies as images: colour and depth have the same pixels.
RgbdCamera testimony_camera(RgbdCamera camera) {
  camera.depth = every(TestimonyGrid(camera.depth).step(), camera.depth);
  camera.color = camera.depth;
  camera.color_from_depth = {};
  return camera;
}

RgbdFrame images_of(const Testimony& testimony, const RgbdCamera& camera, double stamp_s) {
  RgbdFrame images;
  images.color_stamp_s = images.depth_stamp_s = stamp_s;
  if (!testimony.is_given) {
    images.missing = camera.name + ": no images";
    return images;
  }
  Image<std::uint16_t>& depth = images.depth.own();
  Image<Bgr>& color = images.color.own();
  depth.resize(testimony.depth_m.width(), testimony.depth_m.height());
  color.resize(depth.width(), depth.height());
  const double units_per_m = 1 / camera.depth_unit_m;
  std::transform(testimony.depth_m.begin(), testimony.depth_m.end(), depth.begin(),
                 [&](float z) { return static_cast<std::uint16_t>(std::lrint(z * units_per_m)); });
  std::transform(testimony.depth_m.begin(), testimony.depth_m.end(), testimony.color.begin(),
                 color.begin(), [](float z, const Bgr& there) { return z > 0 ? there : Bgr{}; });
  return images;
}

Testimony testimony_of(const RgbdFrame& images, const RigidTransform& depth_from_world,
                       double unit_m) {
  Testimony testimony;
  testimony.is_given = true;
  testimony.depth_from_world = depth_from_world;
  copy(images.color.view(), testimony.color);
  const ImageView<std::uint16_t> depth = images.depth.view();
  testimony.depth_m.resize(depth.width(), depth.height());
  for (int y = 0; y < depth.height(); ++y) {
    std::transform(depth.row(y), depth.row(y) + depth.width(), testimony.depth_m.row(y),
                   [&](std::uint16_t units) {
                     return static_cast<float>(units) * static_cast<float>(unit_m);
                   });
  }
  return testimony;
}

PosedFrame to_frame(const Keyframe& keyframe) {
  PosedFrame posed;
  FrameSet& frame = posed.frame;
  frame.stamp_s = keyframe.stamp_s;
  copy(ImageView<Bgr>(keyframe.picture), frame.color.own());
  RgbdFrame& memory = frame.rgbd.emplace_back();
  memory.color = frame.color;
  Image<std::uint16_t>& depth = memory.depth.own();
  depth = keyframe.depth;
  std::transform(depth.begin(), depth.end(), keyframe.doubt.begin(), depth.begin(),
                 [](std::uint16_t z, std::uint8_t doubt) { return doubt != 0 ? 0 : z; });
  memory.color_stamp_s = memory.depth_stamp_s = keyframe.stamp_s;
  Poses& poses = posed.poses;
  poses.color_from_world = keyframe.color_from_world;
  poses.depth_from_world.emplace_back(keyframe.color_from_world);
  poses.color_from_depth.emplace_back(RigidTransform());
  return posed;
}

/// Of RGB-D camera `k`.
void add_testimony(const Keyframe& keyframe, std::size_t k, const RgbdCamera& camera,
                   PosedFrame& posed) {
  const Testimony& testimony = keyframe.testimonies[k];
  posed.frame.rgbd.push_back(images_of(testimony, camera, keyframe.stamp_s));
  posed.poses.depth_from_world.emplace_back();
  posed.poses.color_from_depth.emplace_back();
  if (!testimony.is_given) return;
  posed.poses.depth_from_world.back() = testimony.depth_from_world;
  posed.poses.color_from_depth.back() = keyframe.color_from_depth[k];
}

/// memory: the first RGB-D camera's images in that frame.
RgbdFrame images_behind(const DiminishedFrame& result, const RgbdFrame& memory,
                        const KeyframeGrid& grid) {
  RgbdFrame images;
  images.color_stamp_s = images.depth_stamp_s = memory.color_stamp_s;
  if (result.report.skipped) {
    images.missing = std::string(behind) + ": no images";
    return images;
  }
  copy(ImageView<Bgr>(result.picture), images.color.own());
  Image<std::uint16_t>& depth = images.depth.own();
  depth.resize(grid.intrinsics().width, grid.intrinsics().height, 0);
  const int step = grid.step();
  const Reconstruction& drawn = result.reconstruction;
  // As far as the objects were left out.
  const Rect part = grow(result.objects, object_margin_px(step));
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const int column = x * step;
      const int row = y * step;
      if (memory.depth(x, y) == 0 && part.contains(column, row) && drawn.source(column, row) != 0) {
        depth(x, y) = KeyframeGrid::units(drawn.depth_m(column, row));
      }
    }
  }
  return images;
}

/// Puts what was seen behind the objects in their place.
void fill_in(const RgbdFrame& images, Keyframe& keyframe) {
  if (!images.available() || images.depth.bounds() != keyframe.depth.bounds() ||
      images.color.bounds() != keyframe.picture.bounds()) {
    return;
  }
  copy(images.color.view(), keyframe.picture);
  for (int y = 0; y < keyframe.depth.height(); ++y) {
    for (int x = 0; x < keyframe.depth.width(); ++x) {
      std::uint16_t& depth = keyframe.depth(x, y);
      if (depth == 0) depth = images.depth(x, y);
    }
  }
}

Keyframe to_keyframe(const PosedFrame& posed, const Scan& scan, const Rig& rig) {
  const FrameSet& frame = posed.frame;
  const Intrinsics grid = KeyframeGrid(rig.color).intrinsics();
  if (!posed.poses.color_from_world || frame.color.bounds() != rig.color.bounds() ||
      frame.rgbd.empty() || frame.rgbd[0].depth.bounds() != grid.bounds()) {
    throw Error(Error::input,
                fmt::format("the background: frame '{}': expected a pose, a picture of {}x{} and "
                            "depth of {}x{}",
                            printable(frame.name), rig.color.width, rig.color.height, grid.width,
                            grid.height));
  }
  Keyframe keyframe;
  keyframe.is_background = true;
  keyframe.stamp_s = frame.stamp_s;
  keyframe.color_from_world = *posed.poses.color_from_world;
  copy(frame.color.view(), keyframe.picture);
  copy(frame.rgbd[0].depth.view(), keyframe.depth);
  keyframe.doubt.resize(keyframe.depth.width(), keyframe.depth.height(), 0);
  keyframe.testimonies.resize(rig.rgbd.size());
  keyframe.color_from_depth.resize(rig.rgbd.size());
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    const RgbdCamera* const camera = find_rgbd_camera(scan.rig, rig.rgbd[k].name);
    if (!camera || !are_alike(camera->depth, testimony_camera(rig.rgbd[k]).depth)) continue;
    const auto index = static_cast<std::size_t>(camera - scan.rig.rgbd.data());
    const auto& depth_from_world = posed.poses.depth_from_world[index];
    if (!frame.rgbd[index].available() || !depth_from_world) continue;
    keyframe.testimonies[k] =
        testimony_of(frame.rgbd[index], *depth_from_world, camera->depth_unit_m);
    keyframe.color_from_depth[k] = posed.poses.color_from_depth[index];
  }
  const RgbdCamera* const extra = find_rgbd_camera(scan.rig, behind);
  const bool is_witnessed =
      std::any_of(keyframe.testimonies.begin(), keyframe.testimonies.end(),
                  [](const Testimony& testimony) { return testimony.is_given; });
  if (extra && !is_witnessed) {
    fill_in(frame.rgbd[static_cast<std::size_t>(extra - scan.rig.rgbd.data())], keyframe);
  }
  return keyframe;
}

std::string text_of(const Scene& scene) {
  if (!(scene.world_marker.size_m > 0)) return "none";
  return fmt::format("{{id: {}, size_m: {}}} of {}", scene.world_marker.id,
                     scene.world_marker.size_m, scene.marker_dictionary);
}

void expect_same_place(const Scan& scan, const Rig& rig, const Scene& scene) {
  if (!are_alike(scan.rig.color, rig.color)) {
    throw Error(Error::input,
                "the background: color: expected the size and lens of this rig's colour camera");
  }
  const MarkerSpec& marker = scene.world_marker;
  const MarkerSpec& other = scan.scene.world_marker;
  if (rig.pose_source == "marker" &&
      (marker.id != other.id || std::abs(marker.size_m - other.size_m) > 1e-6 ||
       scene.marker_dictionary != scan.scene.marker_dictionary)) {
    throw Error(Error::input,
                fmt::format("the background: world_marker: expected {} as in this scene, got {}",
                            text_of(scene), text_of(scan.scene)));
  }
}

}  // namespace

Rig scan_rig(const Rig& rig) {
  Rig result;
  result.color = rig.color;
  result.rgbd.push_back(KeyframeGrid(rig.color).camera());
  result.rgbd[0].name = Scan::camera;
  for (const RgbdCamera& camera : rig.rgbd) result.rgbd.push_back(testimony_camera(camera));
  result.pose_source = "file";
  return result;
}

void expect_world(const Rig& rig) {
  if (rig.pose_source != "fixed") return;
  rig.pose.find("source").fail(
      "expected marker or file for a scan or a background: fixed poses have no world that two "
      "recordings share");
}

Scan make_scan(const std::vector<std::shared_ptr<Keyframe>>& keyframes, const Rig& rig,
               const Scene& scene) {
  expect_world(rig);
  const Rig all = scan_rig(rig);
  Scan scan{all, scene, {}};
  scan.rig.rgbd.resize(1);
  std::vector<std::size_t> witnesses;
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    const auto saw = [k](const auto& keyframe) { return keyframe->testimonies[k].is_given; };
    if (std::none_of(keyframes.begin(), keyframes.end(), saw)) continue;
    witnesses.push_back(k);
    scan.rig.rgbd.push_back(all.rgbd[k + 1]);
  }
  for (const auto& keyframe : keyframes) {
    PosedFrame posed = to_frame(*keyframe);
    for (const std::size_t k : witnesses) add_testimony(*keyframe, k, rig.rgbd[k], posed);
    posed.frame.index = scan.frames.size();
    posed.frame.name = fmt::format("{:06}", posed.frame.index);
    scan.frames.push_back(std::move(posed));
  }
  return scan;
}

void add_behind(const std::function<const DiminishedFrame&(std::size_t frame)>& results,
                Scan& scan) {
  const KeyframeGrid grid(scan.rig.color);
  for (std::size_t i = 0; i < scan.frames.size(); ++i) {
    PosedFrame& posed = scan.frames[i];
    const DiminishedFrame& result = results(i);
    posed.frame.name = result.name;
    RgbdFrame images = images_behind(result, posed.frame.rgbd.front(), grid);
    posed.frame.rgbd.push_back(std::move(images));
    posed.poses.depth_from_world.push_back(posed.poses.color_from_world);
    posed.poses.color_from_depth.emplace_back(RigidTransform());
  }
  scan.rig.rgbd.push_back(scan.rig.rgbd.front());
  scan.rig.rgbd.back().name = behind;
}

std::vector<Keyframe> keyframes_of(const Scan& scan, const Rig& rig, const Scene& scene) {
  expect_world(rig);
  expect_same_place(scan, rig, scene);
  std::vector<Keyframe> keyframes;
  for (const PosedFrame& posed : scan.frames) keyframes.push_back(to_keyframe(posed, scan, rig));
  return keyframes;
}

}  // namespace diminish

// How soon a frame is in doubt when its set-up is wrong, and whether good ones are not
// (docs/doubt.md).
//   diminish_doubt_figures RECORDING...
//
// Each recording is played there and back, as it is and with each fault: a marker's size, an RGB-D
// camera that was bumped, a depth unit, another camera's lens, images that are late, a scan of each
// of the other recordings' places. Prints for each, of frames with an object: how many there were
// and how many in doubt; in how many of the stretches of three frames one is; what the fault costs
// inside the mask, in decibels, if the recording has the truth.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "core/mat.h"
#include "diminish/diminish.h"
#include "source/image_file.h"

namespace diminish {
namespace {

/// A fault must be found within so many frames.
constexpr std::size_t soon = 3;
constexpr double delay_s = 0.15;
/// What a late camera's images come after, so that earlier frames are known.
constexpr std::size_t good_frames = 10;
constexpr std::size_t most_onsets = 24;

Eigen::Matrix3d turned() {
  constexpr double degree = std::numbers::pi / 180;
  return Eigen::AngleAxisd(2 * degree, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

/// An outside tracker's poses, and a user's camera that was turned since it was mounted.
class TurnedCamera : public PoseSource {
 public:
  TurnedCamera(const Rig& rig, const Scene& scene)
      : tracked_(Registry<PoseSource>::get("file")(rig, scene)) {}
  bool needs_markers() const override { return tracked_->needs_markers(); }
  void estimate(const FrameSet& frame, const Markers& markers, Poses& poses) override {
    tracked_->estimate(frame, markers, poses);
    if (!poses.color_from_world) return;
    poses.color_from_world =
        RigidTransform{turned(), Eigen::Vector3d::Zero()} * *poses.color_from_world;
  }

 private:
  std::unique_ptr<PoseSource> tracked_;
};
const bool registered = Registry<PoseSource>::add("turned", [](const Rig& rig, const Scene& scene) {
  return std::make_unique<TurnedCamera>(rig, scene);
});

/// A recording's frames, there and back.
class Player {
 public:
  explicit Player(const Recording& recording) {
    const auto source = open_recording(recording, {});
    for (FrameSet frame; source->next(frame);) frames_.push_back(frame);
    if (frames_.size() < 2) throw Error("expected a recording of two frames or more");
    period_s_ = (frames_.back().stamp_s - frames_.front().stamp_s) /
                static_cast<double>(frames_.size() - 1);
  }

  std::size_t lap() const { return 2 * frames_.size() - 2; }
  double period_s() const { return period_s_; }
  const FrameSet& recorded(std::size_t number) const {
    const std::size_t place = number % lap();
    return frames_[place < frames_.size() ? place : lap() - place];
  }
  /// RGB-D images are of so many frames before.
  FrameSet frame(std::size_t number, std::size_t frames_late = 0) const {
    FrameSet frame = recorded(number);
    frame.rgbd = recorded(number + lap() - frames_late % lap()).rgbd;
    frame.index = number;
    frame.stamp_s = start_s + static_cast<double>(number) * period_s_;
    for (RgbdFrame& camera : frame.rgbd) {
      camera.color_stamp_s = camera.depth_stamp_s = frame.stamp_s;
    }
    return frame;
  }

 private:
  static constexpr double start_s = 1000;
  std::vector<FrameSet> frames_;
  double period_s_ = 0;
};

/// What frames with an object came to.
struct Figures {
  std::size_t frames = 0, in_doubt = 0, stretches = 0, found = 0;
  double squares = 0, pixels = 0;  ///< of the errors inside the masks
  double least_fit = 1;

  std::optional<double> decibels() const {
    if (pixels == 0) return std::nullopt;
    return 10 * std::log10(255. * 255. / std::max(1e-9, squares / pixels));
  }
};

/// The errors of a picture inside the mask, where there is a truth.
void compare(const Recording& recording, const DiminishedFrame& result, Figures& figures) {
  auto file = recording.folder / "truth" / "background" / (result.name + ".jpg");
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) file.replace_extension(".png");
  if (!std::filesystem::exists(file, ignored)) return;
  const cv::Mat truth = decode<Bgr>(read_bytes(file));
  for (int y = 0; y < result.mask.height(); ++y) {
    const Bgr* const row = truth.ptr<Bgr>(y);
    for (int x = 0; x < result.mask.width(); ++x) {
      if (result.mask(x, y) == 0) continue;
      const Bgr& shown = result.picture(x, y);
      for (const int error : {shown.b - row[x].b, shown.g - row[x].g, shown.r - row[x].r}) {
        figures.squares += error * error;
      }
      figures.pixels += 3;
    }
  }
}

/// Adds a frame. Returns whether it is in doubt; nothing if it shows nothing.
std::optional<bool> add(const Recording& recording, const DiminishedFrame& result, bool is_shown,
                        Figures& figures) {
  if (result.objects.empty() || !is_shown) return std::nullopt;
  ++figures.frames;
  figures.in_doubt += result.report.in_doubt ? 1 : 0;
  for (const auto& fit : result.report.fit) {
    if (fit) figures.least_fit = std::min(figures.least_fit, *fit);
  }
  compare(recording, result, figures);
  return result.report.in_doubt;
}

void count_stretches(const std::vector<bool>& doubts, Figures& figures) {
  for (std::size_t i = 0; i + soon <= doubts.size(); ++i) {
    ++figures.stretches;
    const auto begin = doubts.begin() + static_cast<std::ptrdiff_t>(i);
    figures.found += std::find(begin, begin + soon, true) != begin + soon ? 1 : 0;
  }
}

/// The whole recording with this rig and scene. With a scan, frames count that show some of it.
Figures play(const Recording& recording, const Player& player, const Rig& rig, const Scene& scene,
             const Scan* scan = nullptr) {
  Pipeline pipeline(rig, scene, {});
  if (scan) pipeline.set_background(*scan);
  Figures figures;
  std::vector<bool> doubts;
  DiminishedFrame result;
  for (std::size_t i = 0; i < player.lap(); ++i) {
    FrameSet frame = player.frame(i);
    frame.rgbd.resize(rig.rgbd.size());
    pipeline.process(frame, result);
    const bool is_shown = !scan || result.report.memory.background_pixels > 0;
    if (const auto doubt = add(recording, result, is_shown, figures)) doubts.push_back(*doubt);
  }
  count_stretches(doubts, figures);
  return figures;
}

/// Frames whose RGB-D images are late all of a sudden.
Figures play_late(const Recording& recording, const Player& player) {
  const auto late =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(delay_s / player.period_s())));
  Figures figures;
  const std::size_t step = std::max<std::size_t>(1, player.lap() / most_onsets);
  for (std::size_t onset = 0; onset < player.lap(); onset += step) {
    Pipeline pipeline(recording.rig, recording.scene, {});
    DiminishedFrame result;
    std::vector<bool> doubts;
    for (std::size_t i = 0; i < good_frames + soon; ++i) {
      const bool is_late = i >= good_frames;
      pipeline.process(player.frame(onset + i, is_late ? late : 0), result);
      if (!is_late) continue;
      if (const auto doubt = add(recording, result, true, figures)) doubts.push_back(*doubt);
    }
    count_stretches(doubts, figures);
  }
  return figures;
}

void print(const Recording& recording, const std::string& fault, const Figures& figures,
           const Figures& good) {
  const auto decibels = figures.decibels();
  const auto good_decibels = good.decibels();
  std::printf(
      "%-12s %-26s %6zu %8zu %9s %7s %7.2f\n", recording.folder.filename().c_str(), fault.c_str(),
      figures.frames, figures.in_doubt,
      fmt::format("{}/{}", figures.found, figures.stretches).c_str(),
      decibels && good_decibels ? fmt::format("{:.1f}", *decibels - *good_decibels).c_str() : "",
      figures.least_fit);
  std::fflush(stdout);
}

void scale(Intrinsics& camera, double by) {
  camera.fx *= by;
  camera.fy *= by;
}

/// Another camera's lens, for pictures of this camera's size.
Intrinsics lens_for(const Intrinsics& lens, const Intrinsics& size) {
  Intrinsics result = lens;
  const double by = static_cast<double>(size.width) / lens.width;
  result.width = size.width;
  result.height = size.height;
  result.fx *= by;
  result.fy *= by;
  result.cx = (lens.cx + 0.5) * by - 0.5;
  result.cy = (lens.cy + 0.5) * by - 0.5 + (size.height - by * lens.height) / 2;
  return result;
}

void resize_objects_marker(Scene& scene, double by) {
  for (OccluderSpec& occluder : scene.occluders) {
    const auto* const settings = dynamic_cast<const MarkerSettings*>(occluder.settings.get());
    if (!settings) continue;
    auto changed = std::make_shared<MarkerSettings>(*settings);
    changed->marker.size_m *= by;
    occluder.settings = changed;
  }
}

bool has_objects_marker(const Scene& scene) {
  return std::any_of(scene.occluders.begin(), scene.occluders.end(), [](const OccluderSpec& spec) {
    return spec.settings && spec.settings->marker_on_it();
  });
}

void examine(const Recording& recording, const std::vector<Recording>& all) {
  const Player player(recording);
  const Figures good = play(recording, player, recording.rig, recording.scene);
  print(recording, "as it is", good, good);
  const auto with = [&](const std::string& fault, const std::function<void(Rig&, Scene&)>& spoil) {
    Rig rig = recording.rig;
    Scene scene = recording.scene;
    spoil(rig, scene);
    print(recording, fault, play(recording, player, rig, scene), good);
  };
  const bool has_poses = recording.rig.pose_source == "file";
  for (const double by : {1.1, 0.9}) {
    if (!has_poses) {
      with(fmt::format("world marker x {}", by),
           [&](Rig&, Scene& scene) { scene.world_marker.size_m *= by; });
    }
    if (!has_objects_marker(recording.scene)) continue;
    with(fmt::format("object's marker x {}", by),
         [&](Rig&, Scene& scene) { resize_objects_marker(scene, by); });
  }
  if (has_poses) {
    with("user's camera turned 2", [](Rig& rig, Scene&) { rig.pose_source = "turned"; });
  }
  with("depth sensor turned 2", [](Rig& rig, Scene&) {
    for (RgbdCamera& camera : rig.rgbd) camera.color_from_depth.rotation *= turned();
  });
  for (const double by : {1.25, 0.8, 5., 0.2}) {
    with(fmt::format("depth unit x {}", by), [&](Rig& rig, Scene&) {
      for (RgbdCamera& camera : rig.rgbd) camera.depth_unit_m *= by;
    });
  }
  for (const double by : {0.88, 0.95, 1.05, 1.12}) {
    with(fmt::format("user's lens x {}", by), [&](Rig& rig, Scene&) { scale(rig.color, by); });
  }
  with("user's lens another's",
       [](Rig& rig, Scene&) { rig.color = lens_for(rig.rgbd.front().color, rig.color); });
  with("RGB-D lens the user's", [](Rig& rig, Scene&) {
    for (RgbdCamera& camera : rig.rgbd) camera.color = lens_for(rig.color, camera.color);
  });
  print(recording, "RGB-D 150 ms late", play_late(recording, player), good);
  for (const Recording& other : all) {
    if (other.folder == recording.folder) continue;
    try {
      Recording scanned = other;
      scanned.scene.world_marker = recording.scene.world_marker;
      scanned.rig.color = recording.rig.color;
      const Scan scan = scan_recording(scanned, {}, {});
      for (const bool alone : {false, true}) {
        Rig rig = recording.rig;
        if (alone) rig.rgbd.clear();
        const Figures figures = play(recording, player, rig, recording.scene, &scan);
        print(recording, "scan: " + other.folder.filename().string() + (alone ? " alone" : ""),
              figures, good);
      }
    } catch (const Error& error) {
      std::printf("%-12s scan of %s: refused: %s\n", recording.folder.filename().c_str(),
                  other.folder.filename().c_str(), error.what());
    }
  }
}

}  // namespace
}  // namespace diminish

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: diminish_doubt_figures RECORDING...\n");
    return 2;
  }
  std::vector<diminish::Recording> recordings;
  for (int i = 1; i < argc; ++i) recordings.push_back(diminish::load_recording(argv[i]));
  std::printf("%-12s %-26s %6s %8s %9s %7s %7s\n", "", "", "frames", "in doubt", "within 3", "dB",
              "fit");
  for (const diminish::Recording& recording : recordings) diminish::examine(recording, recordings);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

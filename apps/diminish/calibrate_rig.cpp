#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrate.h"
#include "diminish/frame_source.h"
#include "diminish/rig_calibration.h"
#include "live/live_frame_source.h"
#include "live_setup.h"
#include "setup/calibrate/rig_file.h"
#include "setup/calibrate/rig_repair.h"

namespace diminish {
namespace {

struct CalibrateRigCommand {
  LiveSetup setup;
  std::filesystem::path out;
  std::string board;
  bool depth = false;
  bool fixed = false;
  bool repair = false;
  double seconds = 3;
  std::size_t frames = 300;

  int execute() const { return repair ? mend() : measure(); }
  int measure() const;
  int mend() const;
  void look(const Recording& input, RigRepair& rig) const;
};

/// The frames to look at: evenly spread. The source has to read all of them.
RigCalibration collect(const Recording& recording, const std::optional<Board>& board,
                       std::size_t most) {
  RigCalibration calibration(recording.rig, recording.scene, board);
  const auto source = open_recording(recording, Options{});
  const std::size_t count = source->frame_count();
  const std::size_t used = std::min(most, count);
  FrameSet frame;
  for (std::size_t i = 0, taken = 0; taken < used && source->next(frame); ++i) {
    if (i != taken * count / used) continue;
    ++taken;
    calibration.add(frame);
  }
  return calibration;
}

void print(const std::string& name, const DepthToColor& result) {
  fmt::print("{}: pose of the depth sensor in its colour sensor's frame, from {} sightings\n", name,
             result.sightings);
  fmt::print("  distance of the depth from the markers' planes {:.1f} mm, before {:.1f} mm (rms)\n",
             1000 * result.error_m, 1000 * result.error_before_m);
  const Eigen::Vector3d t = 1000 * result.color_from_depth.translation;
  fmt::print(
      "  at {:.1f}, {:.1f}, {:.1f} mm, turned by {:.2f} degrees\n", t.x(), t.y(), t.z(),
      rotation_difference_deg(result.color_from_depth.rotation, Eigen::Matrix3d::Identity()));
}

void print(const std::string& name, const ColorFromRgbd& result) {
  fmt::print("{}: pose in the colour camera's frame, from {} of {} sightings\n", name,
             result.agreeing, result.sightings);
  fmt::print("  reprojection error {:.2f} pixels (with a pose for each sighting: {:.2f})\n",
             result.error_px, result.least_error_px);
  const Eigen::Vector3d t = 1000 * result.color_from_depth.translation;
  fmt::print("  at {:.1f}, {:.1f}, {:.1f} mm +- {:.1f} mm, +- {:.3f} degrees\n", t.x(), t.y(),
             t.z(), 1000 * result.deviation_m, result.deviation_deg);
}

void print(const RepairedPose& pose) {
  fmt::print("{}: turned by {:.2f} degrees and moved by {:.0f} mm\n", pose.camera, pose.turned_deg,
             1000 * pose.moved_m);
  fmt::print("  fits the colour camera's pictures by {:.2f}, before by {:.2f}\n", pose.fit,
             pose.fit_before);
}

/// Frames spread over a recording, or of live cameras.
void CalibrateRigCommand::look(const Recording& input, RigRepair& rig) const {
  FrameSet frame;
  if (setup.has_live_cameras(input.rig)) {
    const LiveRun run = setup.start();
    LiveFrameSource source(*run.session, seconds);
    while (rig.frames() < RigRepair::most_frames && source.next(frame)) rig.add(frame);
    return;
  }
  const auto source = open_recording(input, Options{});
  const std::size_t count = source->frame_count();
  for (std::size_t i = 0; source->next(frame); ++i) {
    if (i >= rig.frames() * count / RigRepair::most_frames) rig.add(frame);
  }
}

int CalibrateRigCommand::mend() const {
  const Recording input = load_recording(setup.folder);
  RigFile rig(out, setup.rig_file());
  RigRepair mending(input.rig, input.scene);
  look(input, mending);
  std::vector<std::pair<std::string, RigidTransform>> color_from_rgbd;
  std::vector<std::string> in_doubt;
  for (const RepairedPose& pose : mending.repair()) {
    print(pose);
    color_from_rgbd.emplace_back(pose.camera, pose.color_from_rgbd);
    if (pose.fit < Options{}.least_fit) in_doubt.push_back(pose.camera);
  }
  for (const std::string& camera : in_doubt) {
    fmt::print(
        "Warning: {}: not mended; expected a pose that fits by {:.1f}: calibrate it with a "
        "board\n",
        camera, Options{}.least_fit);
  }
  if (!in_doubt.empty()) return done_with_warnings;
  rig.set_fixed_poses(color_from_rgbd);
  rig.write();
  fmt::print("Written to {}\n", out.string());
  return 0;
}

int CalibrateRigCommand::measure() const {
  const Recording input = load_recording(setup.folder);
  RigFile rig(out, setup.rig_file());
  std::optional<Board> known_board;
  if (!board.empty()) known_board = parse_board(board);
  const RigCalibration calibration = collect(input, known_board, frames);

  std::vector<std::string> warnings;
  const auto note = [&](const std::vector<std::string>& more) {
    warnings.insert(warnings.end(), more.begin(), more.end());
  };
  std::vector<std::pair<std::string, RigidTransform>> color_from_rgbd;
  for (std::size_t k = 0; k < input.rig.rgbd.size(); ++k) {
    const RgbdCamera& camera = input.rig.rgbd[k];
    RigidTransform own = camera.color_from_depth;
    if (depth) {
      const DepthToColor result = calibration.depth_to_color(k);
      print(camera.name, result);
      note(result.warnings);
      if (result.undetermined.empty()) {
        own = result.color_from_depth;
        rig.set_color_from_depth(camera.name, own);
      } else {
        fmt::print("  color_from_depth is unchanged\n");
      }
    }
    if (fixed || !depth) {
      const ColorFromRgbd result = calibration.color_from_rgbd(k, own);
      print(camera.name, result);
      note(result.warnings);
      color_from_rgbd.emplace_back(camera.name, result.color_from_depth);
    }
  }
  if (!color_from_rgbd.empty()) rig.set_fixed_poses(color_from_rgbd);
  rig.write();
  fmt::print("Written to {}\n", out.string());
  for (const std::string& warning : warnings) fmt::print("Warning: {}\n", warning);
  return warnings.empty() ? 0 : done_with_warnings;
}

}  // namespace

void add_calibrate_rig(CLI::App& calibrate, int& exit_code) {
  auto command = std::make_shared<CalibrateRigCommand>();
  CLI::App* sub = calibrate.add_subcommand(
      "rig", "Calibrates the poses of fixed cameras from markers or a board that they see");
  sub->add_option(
         "recording", command->setup.folder,
         "A recording of the scene's markers, or of a board, in many places; with --repair "
         "of the scene as it is, or a folder with rig.yaml and scene.yaml")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("--out", command->out,
                  "The rig.yaml to write; if missing, it starts as a copy of the recording's")
      ->type_name("FILE")
      ->required();
  sub->add_option("--board", command->board,
                  "Look for this board instead of the markers: charuco:... or checkerboard:...");
  sub->add_flag("--fixed", command->fixed,
                "Poses of the RGB-D cameras in the colour camera's frame: pose: {source: fixed} "
                "(the default without --depth)");
  sub->add_flag("--depth", command->depth,
                "Pose of each RGB-D camera's depth sensor in its own colour sensor's frame: "
                "color_from_depth");
  sub->add_flag("--repair", command->repair,
                "Finds fixed poses again after a camera was bumped, from the scene alone: turns of "
                "up to 4 degrees");
  command->setup.add_camera_flags(*sub);
  sub->add_option("--seconds", command->seconds, "How long to watch live cameras (--repair)")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 3600.0))
      ->type_name("S");
  sub->add_option("--frames", command->frames, "Most frames to use from the recording")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000))
      ->type_name("N");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish

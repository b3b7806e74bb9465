#include "live_setup.h"

#include <fmt/format.h>

#include <atomic>
#include <csignal>

#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "option_flags.h"

namespace diminish {
namespace {

std::atomic<bool> stop_flag = false;

}  // namespace

void stop_on_signals() {
  std::signal(SIGINT, [](int) { stop_flag = true; });
  std::signal(SIGTERM, [](int) { stop_flag = true; });
}
bool stop_requested() {
  return stop_flag;
}

void LiveSetup::add_flags(CLI::App& command) {
  command
      .add_option("setup", folder,
                  "Folder with rig.yaml and scene.yaml; a recording is replayed in a loop if no "
                  "cameras are given")
      ->type_name("FOLDER")
      ->required();
  add_camera_flags(command);
  command
      .add_option("--budget", live_options.budget_ms,
                  "Time budget of a frame; quality steps down when frames take longer")
      ->check(CLI::Range(0.0, 10000.0))
      ->type_name("MILLISECONDS");
  command
      .add_option("--threads", live_options.threads,
                  "Threads to use inside a frame; 0: one per core")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
  command
      .add_option("--frames-in-flight", live_options.frames_in_flight,
                  "Frames that are worked on at the same time; 0: two with four threads or more, "
                  "else one")
      ->capture_default_str()
      ->check(CLI::Range(0, 16))
      ->type_name("N");
  command
      .add_option(
          "--sync-wait", live_options.sync_wait_s,
          "How long a colour image waits for its RGB-D images; 0: about as long as the last "
          "ones needed")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10.0))
      ->type_name("SECONDS");
  add_option_flags(command, options);
  background.add_flag(command, options);
  flags.add_to(command);
}

bool LiveSetup::has_live_cameras(const Rig& rig) const {
  if (!color.empty() || !rgbd.empty()) return true;
  // A recording that was made with live cameras names them, too.
  std::error_code ignored;
  return !rig.live.empty() && !std::filesystem::exists(folder / "color.txt", ignored);
}

std::vector<LiveCamera> LiveSetup::cameras(const Rig& rig) const {
  std::vector<LiveCamera> result;
  if (color.empty() && rgbd.empty()) {
    if (has_live_cameras(rig)) return rig.live;
    const std::string replay = "recording:" + folder.string() + "?loop";
    result.push_back({"color", replay});
    for (const RgbdCamera& camera : rig.rgbd) result.push_back({camera.name, replay});
    return result;
  }
  result.push_back({"color", color});
  if (color.empty()) throw Error("--color: expected a camera as well as --rgbd");
  std::size_t next = 0;
  for (const std::string& text : rgbd) {
    const std::size_t equals = text.find('=');
    // "NAME=scheme:...": the name ends before the first colon.
    if (equals != std::string::npos && equals < text.find(':')) {
      result.push_back({text.substr(0, equals), text.substr(equals + 1)});
    } else if (next < rig.rgbd.size()) {
      result.push_back({rig.rgbd[next++].name, text});
    } else {
      throw Error("--rgbd " + text + ": the rig has only " + std::to_string(rig.rgbd.size()) +
                  " RGB-D cameras; name them as NAME=CAMERA if one has several devices");
    }
  }
  return result;
}

void LiveSetup::add_camera_flags(CLI::App& command) {
  command.add_option("--color", color, "The camera of the user's view, such as v4l2:/dev/video0")
      ->type_name("CAMERA");
  command
      .add_option("--rgbd", rgbd,
                  "An RGB-D camera, in the rig's order or as NAME=CAMERA; twice with the same name "
                  "for separate colour and depth devices. See `diminish devices`")
      ->type_name("[NAME=]CAMERA");
}

void LiveSetup::add_output_flags(CLI::App& command) {
  command
      .add_option(
          "--record", record,
          "Write what the cameras see to this folder as a recording; frames for which there "
          "is no time are dropped and counted")
      ->type_name("FOLDER");
  command
      .add_option("--virtual-camera", virtual_camera,
                  "Send the result to this v4l2loopback device, for programs that read a camera")
      ->type_name("DEVICE");
  command
      .add_option("--ros2", ros2,
                  "Publish the result as ROS 2 topics below this name, such as /diminish; "
                  "?interface=ADDRESS lets other machines see them")
      ->type_name("NAME");
}

void LiveRun::say_output_problem() {
  const auto end_if_broken = [](auto& output) {
    if (!output || output->problem().empty()) return;
    fmt::print(stderr, "diminish: {}\n", output->problem());
    output.reset();
  };
  end_if_broken(virtual_camera);
  end_if_broken(ros2);
}

LiveRun LiveSetup::start() const {
  Rig rig = load_rig(rig_file());
  Scene scene = load_scene(scene_file());
  flags.apply(rig, scene);
  std::vector<LiveCamera> all = cameras(rig);
  if (draw_clock) all.front().uri = "clock:" + all.front().uri;
  LiveOptions with_background = live_options;
  with_background.background = background.load();
  LiveRun run;
  if (!record.empty()) {
    run.recording = std::make_shared<RecordingWriter>(record, rig_file(), rig, scene_file(), scene);
  }
  run.session = std::make_unique<LiveSession>(rig, scene, options, all, with_background);
  if (run.recording) {
    run.recording_listener = run.session->on_frame(
        [writer = run.recording](const auto& frame) { writer->offer(frame); });
  }
  if (!virtual_camera.empty()) {
    constexpr double usual_rate = 30;
    run.virtual_camera = std::make_unique<VirtualCamera>(*run.session, virtual_camera, usual_rate);
  }
  if (!ros2.empty()) run.ros2 = std::make_unique<Ros2Output>(*run.session, ros2);
  return run;
}

}  // namespace diminish

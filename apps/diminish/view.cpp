#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/highgui.hpp>

#include "commands.h"
#include "core/mat.h"
#include "diminish/error.h"
#include "live_setup.h"

namespace diminish {
namespace {

constexpr const char* window = "diminish";
constexpr std::array<const char*, 3> display_variables = {"DISPLAY", "WAYLAND_DISPLAY",
                                                          "QT_QPA_PLATFORM"};
constexpr const char* keys =
    "Keys: 1-5 view mode, b the camera's picture, o objects on and off, + and - mask margin,\n"
    "      f full screen, q or Escape quit";

struct ViewCommand {
  LiveSetup setup;

  int execute() const;
};

/// What the keys change.
class Viewer {
 public:
  explicit Viewer(LiveSession& session) : session_(session) {}

  bool before() const { return before_; }
  /// False: quit.
  bool press(int key) {
    constexpr int escape = 27;
    Options options = session_.options();
    const std::vector<std::string> modes = method_names("mode");
    if (key == 'q' || key == escape) return false;
    if (key == 'b') before_ = !before_;
    if (key == 'f') toggle_full_screen();
    if (key >= '1' && key < '1' + static_cast<int>(modes.size())) {
      options.mode = modes[static_cast<std::size_t>(key - '1')];
    }
    if (key == '+') options.mask_margin_px = std::min(options.mask_margin_px + 1, 200);
    if (key == '-') options.mask_margin_px = std::max(options.mask_margin_px - 1, 0);
    if (key == 'o') options.keep = options.keep.empty() ? all_objects() : "";
    session_.set_options(options);
    return true;
  }

 private:
  std::string all_objects() const {
    std::string names;
    for (const OccluderSpec& occluder : session_.scene().occluders) {
      names += (names.empty() ? "" : ",") + occluder.name;
    }
    return names;
  }
  void toggle_full_screen() {
    full_screen_ = !full_screen_;
    cv::setWindowProperty(window, cv::WND_PROP_FULLSCREEN,
                          full_screen_ ? cv::WINDOW_FULLSCREEN : cv::WINDOW_NORMAL);
  }

  LiveSession& session_;
  bool before_ = false;
  bool full_screen_ = false;
};

/// OpenCV's window library may end the whole program without one.
bool has_display() {
  return std::any_of(display_variables.begin(), display_variables.end(),
                     [](const char* name) { return std::getenv(name) != nullptr; });
}

int ViewCommand::execute() const {
  if (!has_display()) {
    throw Error("view: there is no display to open a window on; try `diminish serve`");
  }
  stop_on_signals();
  LiveRun run = setup.start();
  cv::namedWindow(window, cv::WINDOW_NORMAL);
  fmt::print("{}\n", keys);
  Viewer viewer(*run.session);
  std::size_t number = 0;
  while (!stop_requested() && !run.session->status().ended) {
    run.say_output_problem();
    const auto frame = run.session->wait_for_frame(number, std::chrono::milliseconds(30));
    if (frame) {
      number = frame->number;
      cv::imshow(window, as_mat(viewer.before() ? frame->input.color : frame->result.picture));
    }
    const int key = cv::waitKey(1);
    if (key >= 0 && !viewer.press(key)) break;
    if (number > 0 && cv::getWindowProperty(window, cv::WND_PROP_VISIBLE) < 1) break;
  }
  return 0;
}

}  // namespace

void add_view(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<ViewCommand>();
  CLI::App* sub = program.add_subcommand("view", "Runs live and shows the result in a window");
  sub->footer(keys);
  command->setup.add_flags(*sub);
  command->setup.add_output_flags(*sub);
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibrate.h"
#include "core/mat.h"
#include "diminish/calibration.h"
#include "diminish/error.h"
#include "live_setup.h"
#include "setup/calibrate/board_images.h"
#include "setup/calibrate/coverage_picture.h"
#include "setup/calibrate/live_board_images.h"
#include "setup/calibrate/rig_file.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

struct CalibrateIntrinsicsCommand {
  std::vector<std::filesystem::path> images;
  std::filesystem::path recording;
  std::string live;
  double seconds = 120;
  std::filesystem::path out;
  std::filesystem::path plot;
  std::string camera = "color";
  std::string board;
  std::string lens = "plumb_bob";
  std::size_t frames = 300;

  int execute() const;
  std::unique_ptr<BoardImages> open() const;
  ViewCollection collect(BoardImages& images, const BoardDetector& detector) const;
};

std::unique_ptr<BoardImages> CalibrateIntrinsicsCommand::open() const {
  const int sources =
      (images.empty() ? 0 : 1) + (recording.empty() ? 0 : 1) + (live.empty() ? 0 : 1);
  if (sources != 1) {
    throw Error(
        "expected images of the board, --recording with a recording of it, or --live "
        "with a camera");
  }
  if (!live.empty()) return std::make_unique<LiveBoardImages>(live, seconds);
  if (!images.empty()) return std::make_unique<StoredBoardImages>(images);
  return std::make_unique<StoredBoardImages>(recording, camera, frames);
}

/// Finds the board in an image and keeps the view if it helps; says what the image was good for.
std::string use(BoardImages& images, const BoardDetector& detector, Image<Bgr>& image,
                std::optional<ViewCollection>& collection) {
  try {
    images.read(image);
  } catch (const Error& error) {
    return fmt::format("not used: {}", error.what());
  }
  if (!collection) collection.emplace(image.width(), image.height());
  if (image.width() != collection->width() || image.height() != collection->height()) {
    return fmt::format("not used: expected {}x{} pixels like the first image, got {}x{}",
                       collection->width(), collection->height(), image.width(), image.height());
  }
  auto view = detector.detect(image, images.name());
  if (!view) return "not used: the board was not found";
  const std::size_t corners = view->ids.size();
  const std::string reason = collection->add(std::move(*view));
  if (!reason.empty()) return "not used: " + reason;
  return fmt::format("{} corners; so far {} views, coverage {:.0f} %, {} of 5 tilts", corners,
                     collection->views().size(), 100 * collection->coverage(), collection->tilts());
}

/// Collects views until there are no more images; live ones until there are enough.
ViewCollection CalibrateIntrinsicsCommand::collect(BoardImages& source,
                                                   const BoardDetector& detector) const {
  std::optional<ViewCollection> collection;
  std::string first;
  std::string last_use;
  for (Image<Bgr> image; !stop_requested() && source.next();) {
    const std::string name = source.name();
    if (first.empty()) first = name;
    const std::string its_use = use(source, detector, image, collection);
    // Thirty times a second the same is too much to read.
    if (live.empty() || its_use != last_use) fmt::print("{}: {}\n", name, its_use);
    std::fflush(stdout);
    last_use = its_use;
    if (!live.empty() && collection && collection->is_ample()) {
      fmt::print("That is enough\n");
      break;
    }
  }
  if (first.empty()) throw Error(live + ": no image arrived");
  if (!collection) throw Error(first + ": none of the images can be read");
  return std::move(*collection);
}

void print_result(const IntrinsicsCalibration& result) {
  fmt::print("\n{:<40} {:>10}\n", "reprojection error", "pixels");
  std::size_t used = 0;
  for (const auto& view : result.views) {
    fmt::print("{:<40} {:>10.3f}{}\n", view.name, view.error_px,
               view.used ? "" : "  left out: does not agree with the others");
    used += view.used ? 1 : 0;
  }
  fmt::print("{:<40} {:>10.3f}\n\n", fmt::format("all {} used", used), result.error_px);
  const Intrinsics& camera = result.intrinsics;
  std::vector<double> values = {camera.fx, camera.fy, camera.cx, camera.cy};
  std::vector<const char*> names = {"fx", "fy", "cx", "cy", "k1", "k2",
                                    "p1", "p2", "k3", "k4", "k5", "k6"};
  if (camera.lens_model == LensModel::fisheye) {
    names = {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};
  }
  const std::size_t count = coefficient_count(camera.lens_model);
  values.insert(values.end(), camera.distortion.begin(),
                camera.distortion.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (result.deviations[i] == 0) continue;  // was not fitted
    fmt::print("{}  {:>10.{}f} +- {:.{}f}\n", names[i], values[i], i < 4 ? 2 : 5,
               result.deviations[i], i < 4 ? 2 : 5);
  }
}

int CalibrateIntrinsicsCommand::execute() const {
  expect_camera_name(camera);
  const BoardDetector detector(parse_board(board));
  RigFile rig(out);
  stop_on_signals();
  const std::unique_ptr<BoardImages> source = open();
  const ViewCollection views = collect(*source, detector);
  const IntrinsicsCalibration result = calibrate_intrinsics(views, find_lens_model(lens).value());
  print_result(result);
  if (!plot.empty()) write_png(plot, as_mat(coverage_picture(views, result)));
  rig.set_intrinsics(camera, result.intrinsics);
  rig.write();
  fmt::print("Written to {}, camera {}\n", out.string(), camera);
  for (const std::string& warning : result.warnings) fmt::print("Warning: {}\n", warning);
  return result.warnings.empty() ? 0 : done_with_warnings;
}

}  // namespace

void add_calibrate_intrinsics(CLI::App& calibrate, int& exit_code) {
  auto command = std::make_shared<CalibrateIntrinsicsCommand>();
  CLI::App* sub = calibrate.add_subcommand(
      "intrinsics",
      "Calibrates a camera's focal lengths, principal point and lens from images of a board");
  sub->add_option("images", command->images, "Images of the board, or folders of them")
      ->type_name("FILE");
  sub->add_option("--board", command->board,
                  "The printed board: charuco:COLUMNSxROWS:SQUARE_MM:MARKER_MM[:DICTIONARY] or "
                  "checkerboard:COLUMNSxROWS:SQUARE_MM")
      ->required();
  sub->add_option("--recording", command->recording,
                  "Instead of images: a recording of the board, calibrated or not")
      ->type_name("FOLDER");
  sub->add_option(
         "--live", command->live,
         "Instead of images: a live camera (docs/live.md); ends when there are enough views")
      ->type_name("URI");
  sub->add_option("--seconds", command->seconds, "How long to watch the live camera at most")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 86400.0));
  sub->add_option("--camera", command->camera,
                  "Which camera: color, or an RGB-D camera's sensor: rgbd0_color, rgbd0_depth "
                  "(infrared images)")
      ->capture_default_str();
  sub->add_option("--lens", command->lens,
                  "Lens model to fit: plumb_bob (k1, k2, p1, p2, k3), rational (also k4, k5, k6: "
                  "wide-angle lenses) or fisheye (up to 85 degrees off the axis)")
      ->capture_default_str()
      ->check(CLI::IsMember({"plumb_bob", "rational", "fisheye"}));
  sub->add_option("--frames", command->frames, "Most images to use from a recording")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000))
      ->type_name("N");
  sub->add_option("--out", command->out,
                  "The rig.yaml to write this camera's block into; the rest stays as it is")
      ->type_name("FILE")
      ->required();
  sub->add_option("--plot", command->plot,
                  "Write a picture of the corners, their errors and the coverage")
      ->type_name("PNG");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish

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
#include "setup/board_images.h"
#include "setup/coverage_picture.h"
#include "setup/rig_file.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

constexpr int done_with_warnings = 3;

struct CalibrateIntrinsicsCommand {
  std::vector<std::filesystem::path> images;
  std::filesystem::path recording;
  std::filesystem::path out;
  std::filesystem::path plot;
  std::string camera = "color";
  std::string board;
  std::size_t frames = 300;

  int execute() const;
  BoardImages open() const;
};

BoardImages CalibrateIntrinsicsCommand::open() const {
  if (images.empty() == recording.empty()) {
    throw Error("expected images of the board, or --recording with a recording of it");
  }
  return images.empty() ? BoardImages(recording, camera, frames) : BoardImages(images);
}

/// Collects views, saying of each image what it was good for.
ViewCollection collect(BoardImages& images, const BoardDetector& detector) {
  std::optional<ViewCollection> collection;
  Image<Bgr> image;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::string name = images.name(i);
    try {
      images.read(i, image);
    } catch (const Error& error) {
      fmt::print("{}: not used: {}\n", name, error.what());
      continue;
    }
    if (!collection) collection.emplace(images.width(), images.height());
    auto view = detector.detect(image, name);
    if (!view) {
      fmt::print("{}: not used: the board was not found\n", name);
      continue;
    }
    const std::size_t corners = view->ids.size();
    const std::string reason = collection->add(std::move(*view));
    if (!reason.empty()) {
      fmt::print("{}: not used: {}\n", name, reason);
      continue;
    }
    fmt::print("{}: {} corners; so far {} views, coverage {:.0f} %, {} of 5 tilts\n", name, corners,
               collection->views().size(), 100 * collection->coverage(), collection->tilts());
  }
  if (!collection) throw Error(images.name(0) + ": none of the images can be read");
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
  fmt::print("{:<40} {:>10.3f}\n\n", fmt::format("all {} that were used", used), result.error_px);
  const Intrinsics& camera = result.intrinsics;
  const std::array<double, 9> values = {camera.fx,
                                        camera.fy,
                                        camera.cx,
                                        camera.cy,
                                        camera.distortion[0],
                                        camera.distortion[1],
                                        camera.distortion[2],
                                        camera.distortion[3],
                                        camera.distortion[4]};
  constexpr const char* names[] = {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i == 8 && result.deviations[i] == 0) continue;
    fmt::print("{}  {:>10.{}f} +- {:.{}f}\n", names[i], values[i], i < 4 ? 2 : 5,
               result.deviations[i], i < 4 ? 2 : 5);
  }
}

int CalibrateIntrinsicsCommand::execute() const {
  expect_camera_name(camera);
  const BoardDetector detector(parse_board(board));
  RigFile rig(out);
  BoardImages source = open();
  const ViewCollection views = collect(source, detector);
  const IntrinsicsCalibration result = calibrate_intrinsics(views);
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
      "intrinsics", "Focal lengths, principal point and lens of a camera, from images of a board");
  sub->add_option("images", command->images, "Images of the board, or folders of them");
  sub->add_option("--board", command->board,
                  "What was printed: charuco:COLUMNSxROWS:SQUARE_MM:MARKER_MM[:DICTIONARY] or "
                  "checkerboard:COLUMNSxROWS:SQUARE_MM")
      ->required();
  sub->add_option("--recording", command->recording,
                  "Instead of images: a recording of the board, calibrated or not");
  sub->add_option("--camera", command->camera,
                  "Which camera: color, or an RGB-D camera's sensor: rgbd0_color, rgbd0_depth "
                  "(infrared images)")
      ->capture_default_str();
  sub->add_option("--frames", command->frames, "At most so many images of a recording")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000))
      ->type_name("N");
  sub->add_option("--out", command->out,
                  "The rig.yaml whose block of this camera is written; the rest of it stays")
      ->required();
  sub->add_option("--plot", command->plot, "A picture of the corners, their errors and coverage")
      ->type_name("PNG");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish

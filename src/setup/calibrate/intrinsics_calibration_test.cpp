#include <fmt/printf.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "diminish/calibration.h"
#include "expect_error.h"
#include "rendered_targets.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

const Intrinsics true_intrinsics{
    640, 480, 556.3, 554.9, 322.7, 236.1, {-0.21, 0.11, 0.0011, -0.0007, 0}};

/// Poses of a board that is waved before a camera: near and far, leaning, in all corners.
RigidTransform board_pose(int index) {
  const double lean = (index % 5 == 0 ? 5 : 32) * std::numbers::pi / 180;
  const double direction = index * 2.4;
  RigidTransform camera_from_target;
  camera_from_target.rotation =
      (Eigen::AngleAxisd(lean, Eigen::Vector3d(std::cos(direction), std::sin(direction), 0)) *
       Eigen::AngleAxisd(0.3 * std::sin(index), Eigen::Vector3d::UnitZ()))
          .toRotationMatrix() *
      Eigen::Vector3d(1, -1, -1).asDiagonal();
  const double z = 0.38 + 0.03 * (index % 4);
  camera_from_target.translation = {0.3 * z * (index % 3 - 1), 0.22 * z * (index / 3 % 3 - 1), z};
  return camera_from_target;
}

struct Views {
  Image<Bgr> image(int index) const {
    return renderer.color({testing::board_target(board, board_pose(index))}, {}, 0.7, 2.5,
                          static_cast<unsigned>(index));
  }

  Board board;
  testing::TargetRenderer renderer{true_intrinsics};
};

/// The largest distance between what the two cameras make of the same ray, in the whole picture.
double largest_difference_px(const Intrinsics& a, const Intrinsics& b) {
  double largest = 0;
  const Lens lens_a(a);
  const Lens lens_b(b);
  for (int y = 0; y < a.height; y += 16) {
    for (int x = 0; x < a.width; x += 16) {
      const Eigen::Vector2d pixel(x, y);
      const auto other = lens_b.distort(lens_a.undistort(pixel));
      if (!other) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, (*other - pixel).norm());
    }
  }
  return largest;
}

class CalibrateIntrinsics : public ::testing::TestWithParam<const char*> {};

TEST_P(CalibrateIntrinsics, RecoversTheCameraOfRenderedBoards) {
  const Views views{parse_board(GetParam())};
  const BoardDetector detector(views.board);
  ViewCollection collection(true_intrinsics.width, true_intrinsics.height);
  for (int i = 0; i < 24; ++i) {
    auto view = detector.detect(views.image(i), std::to_string(i));
    if (!view) continue;
    EXPECT_EQ(collection.add(std::move(*view)), "") << i;
  }
  ASSERT_GE(collection.views().size(), 14U);
  EXPECT_GT(collection.coverage(), 0.7);
  EXPECT_GE(collection.tilts(), 4);
  const IntrinsicsCalibration result = calibrate_intrinsics(collection);
  EXPECT_THAT(result.warnings, ::testing::IsEmpty());
  const Intrinsics& found = result.intrinsics;
  RecordProperty(
      "figures",
      fmt::sprintf("%s: fx %+.2f fy %+.2f cx %+.2f cy %+.2f (sd %.2f %.2f %.2f %.2f), rms %.3f px, "
                   "largest difference %.2f px, %zu views",
                   GetParam(), found.fx - true_intrinsics.fx, found.fy - true_intrinsics.fy,
                   found.cx - true_intrinsics.cx, found.cy - true_intrinsics.cy,
                   result.deviations[0], result.deviations[1], result.deviations[2],
                   result.deviations[3], result.error_px,
                   largest_difference_px(true_intrinsics, found), result.views.size()));
  EXPECT_NEAR(found.fx, true_intrinsics.fx, 0.002 * true_intrinsics.fx);
  EXPECT_NEAR(found.fy, true_intrinsics.fy, 0.002 * true_intrinsics.fy);
  EXPECT_NEAR(found.cx, true_intrinsics.cx, 1);
  EXPECT_NEAR(found.cy, true_intrinsics.cy, 1);
  EXPECT_EQ(found.distortion[4], 0) << "k3 is not there, and not fitted";
  // In the picture's very corners, where no board was.
  EXPECT_LT(largest_difference_px(true_intrinsics, found), 1.5);
  EXPECT_LT(result.error_px, 0.15);
  // What it says of its own uncertainty is true.
  const double errors[] = {found.fx - true_intrinsics.fx, found.fy - true_intrinsics.fy,
                           found.cx - true_intrinsics.cx, found.cy - true_intrinsics.cy};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GT(result.deviations[i], 0);
    EXPECT_LT(std::abs(errors[i]), 6 * result.deviations[i]) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Boards, CalibrateIntrinsics,
                         ::testing::Values("charuco:7x5:30:22:DICT_4X4_50", "checkerboard:8x5:30"));

/// Views without pictures: projected corners.
BoardView projected_view(int index, const Intrinsics& camera) {
  BoardView view;
  view.name = std::to_string(index);
  const Lens lens(camera);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 9; ++column) {
      const Eigen::Vector3d point((column - 4) * 0.025, (row - 2.5) * 0.025, 0);
      const auto pixel = lens.project(board_pose(index) * point);
      if (!pixel) continue;
      view.ids.push_back(9 * row + column);
      view.points_m.push_back(point);
      view.pixels.push_back(*pixel);
    }
  }
  return view;
}

TEST(CalibrateIntrinsicsToo, IsExactForExactCornersAndFindsK3) {
  Intrinsics camera = true_intrinsics;
  camera.distortion = {-0.2, 0.1, 0.001, -0.002, 0.05};
  ViewCollection collection(camera.width, camera.height);
  for (int i = 0; i < 12; ++i) EXPECT_EQ(collection.add(projected_view(i, camera)), "");
  const IntrinsicsCalibration result = calibrate_intrinsics(collection);
  EXPECT_LT(result.error_px, 1e-3);
  EXPECT_LT(largest_difference_px(camera, result.intrinsics), 0.02);
  EXPECT_NEAR(result.intrinsics.distortion[4], 0.05, 0.02);
}

/// A board that leans in front of one of 30 parts of the picture, corners with errors of 0.02 px.
BoardView leaning_view(int index, const Intrinsics& camera, std::mt19937& random) {
  std::normal_distribution<double> error_px(0, 0.02);
  const Lens lens(camera);
  const int part_row = index / 6;
  const Eigen::Vector2d middle((index % 6 + 0.5) / 6 * camera.width,
                               (part_row + 0.5) / 5 * camera.height);
  const Eigen::Vector3d direction = lens.undistort(middle).homogeneous().normalized();
  const Eigen::Vector3d axis(std::cos(2.4 * index), std::sin(2.4 * index), 0);
  RigidTransform camera_from_board;
  camera_from_board.rotation =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction) *
      Eigen::AngleAxisd(0.5, axis).toRotationMatrix();
  camera_from_board.translation = (0.2 + 0.02 * (index % 4)) * direction;
  BoardView view;
  view.name = std::to_string(index);
  for (int i = 0; i < 54; ++i) {
    const int corner_row = i / 9;
    const Eigen::Vector3d point((i % 9 - 4) * 0.025, (corner_row - 2.5) * 0.025, 0);
    const auto pixel = lens.project(camera_from_board * point);
    if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > camera.width - 1 ||
        pixel->y() > camera.height - 1) {
      continue;
    }
    view.ids.push_back(i);
    view.points_m.push_back(point);
    view.pixels.emplace_back(*pixel + Eigen::Vector2d(error_px(random), error_px(random)));
  }
  return view;
}

ViewCollection seen_through(const Intrinsics& camera) {
  std::mt19937 random(7);
  ViewCollection collection(camera.width, camera.height);
  for (int i = 0; i < 30; ++i) collection.add(leaning_view(i, camera, random));
  return collection;
}

TEST(CalibrateIntrinsicsToo, RecoversRationalLensesAndFisheyes) {
  const Intrinsics cameras[] = {
      {640,
       480,
       420,
       421,
       322.7,
       236.1,
       {0.3, 0.1, 0.0006, -0.0004, 0.02, 0.55, 0.12, 0.03},
       LensModel::rational},
      {640, 480, 380, 379, 318, 243, {0.02, -0.01, 0.003, -0.001}, LensModel::fisheye},
      {640, 480, 340, 340, 318, 243, {-0.008, 0.045, -0.043, 0.008}, LensModel::fisheye}};
  for (const Intrinsics& camera : cameras) {
    SCOPED_TRACE(fmt::sprintf("%s %f", name_of(camera.lens_model), camera.fx));
    const IntrinsicsCalibration result =
        calibrate_intrinsics(seen_through(camera), camera.lens_model);
    EXPECT_EQ(result.intrinsics.lens_model, camera.lens_model);
    EXPECT_LT(result.error_px, 0.04);
    EXPECT_LT(largest_difference_px(camera, result.intrinsics), 0.1);
    const double errors[] = {result.intrinsics.fx - camera.fx, result.intrinsics.fy - camera.fy,
                             result.intrinsics.cx - camera.cx, result.intrinsics.cy - camera.cy};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_GT(result.deviations[i], 0);
      EXPECT_LT(std::abs(errors[i]), 5 * result.deviations[i]) << i;
      EXPECT_LT(result.deviations[i], 1) << i;
    }
  }
}

TEST(CalibrateIntrinsicsToo, WarnsOfFisheyesThatSeeTooMuch) {
  const Intrinsics camera{640, 480, 300, 300, 320, 240, {0, 0, 0, 0}, LensModel::fisheye};
  ViewCollection collection = seen_through(camera);
  const auto usable = calibrate_intrinsics(collection, LensModel::fisheye);
  EXPECT_THAT(usable.warnings, ::testing::Not(::testing::Contains(HasSubstr("85 degrees"))));
  Intrinsics wide = camera;
  wide.fx = wide.fy = 250;
  const auto unusable = calibrate_intrinsics(seen_through(wide), LensModel::fisheye);
  EXPECT_THAT(unusable.warnings, ::testing::Contains(HasSubstr("85 degrees")));
}

TEST(CalibrateIntrinsicsToo, LeavesOutAViewThatDoesNotAgree) {
  ViewCollection collection(true_intrinsics.width, true_intrinsics.height);
  for (int i = 0; i < 12; ++i) {
    BoardView view = projected_view(i, true_intrinsics);
    // As of a bent board, and of a picture that was taken while it moved.
    for (std::size_t c = 0; c < view.pixels.size(); ++c) {
      if (i == 4) view.pixels[c].x() += 3 * std::sin(static_cast<double>(c));
      if (i == 7) view.pixels[c].y() += 0.05 * view.pixels[c].x() * (c % 2 == 0 ? 1 : 0);
    }
    collection.add(std::move(view));
  }
  const IntrinsicsCalibration result = calibrate_intrinsics(collection);
  ASSERT_EQ(result.views.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(result.views[i].used, i != 4 && i != 7) << i;
    EXPECT_EQ(result.views[i].error_px > 0.5, i == 4 || i == 7) << i;
  }
  EXPECT_LT(largest_difference_px(true_intrinsics, result.intrinsics), 0.05);
}

TEST(ViewCollection, SaysWhichViewsDoNotHelp) {
  ViewCollection collection(true_intrinsics.width, true_intrinsics.height);
  EXPECT_EQ(collection.add(projected_view(1, true_intrinsics)), "");
  BoardView again = projected_view(1, true_intrinsics);
  again.pixels[3].x() += 5;
  again.name = "again";
  EXPECT_THAT(collection.add(again), HasSubstr("like 1"));
  EXPECT_EQ(collection.add(projected_view(2, true_intrinsics)), "");
  EXPECT_EQ(collection.views().size(), 2U);
}

TEST(CalibrateIntrinsicsToo, WarnsOfWhatTheViewsDoNotShow) {
  ViewCollection few(true_intrinsics.width, true_intrinsics.height);
  few.add(projected_view(0, true_intrinsics));
  EXPECT_THAT(error_of([&] { calibrate_intrinsics(few); }), HasSubstr("got 1"));
  // Boards that all face the camera.
  for (int i = 1; i < 3; ++i) few.add(projected_view(5 * i, true_intrinsics));
  const auto result = calibrate_intrinsics(few);
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("hardly leans")));
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("only 3 views")));
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("% of the picture")));
}

TEST(BoardDetector, FindsNothingWhereThereIsNoBoard) {
  const Image<Bgr> grey(640, 480, {90, 90, 90});
  for (const char* text : {"charuco:7x5:30:22", "checkerboard:8x5:30"}) {
    EXPECT_FALSE(BoardDetector(parse_board(text)).detect(grey, "grey"));
  }
}

}  // namespace
}  // namespace diminish

#include "diminish/result_writer.h"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <set>
#include <sstream>

#include "analytic_scene.h"
#include "core/mat.h"
#include "diminish/error.h"
#include "score/csv_table.h"
#include "sink/indexed_png.h"
#include "sink/partial_file.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;

class ResultWriterTest : public ::testing::Test {
 protected:
  ResultWriterTest() {
    rig = testing::small_rig();
    frame.name = result.name = "000007";
    frame.color.own().resize(rig.color.width, rig.color.height, {10, 20, 30});
    result.picture.resize(rig.color.width, rig.color.height, {40, 50, 60});
    result.mask.resize(rig.color.width, rig.color.height, 0);
    result.mask.fill({5, 6, 7, 8}, 255);
    result.provenance = result.mask;
    result.reconstruction.color.resize(rig.color.width, rig.color.height, {1, 2, 3, 255});
    result.report.markers.rgbd.resize(1);
    result.report.poses.color_from_world.emplace();
    result.report.poses.depth_from_world.resize(1);
    result.report.poses.color_from_depth.resize(1);
    result.report.occluders = {{.name = "lamp", .in_color = true, .in_rgbd = {true}}};
    result.report.messages = {"a \"quoted\", message", "another"};
  }

  ResultWriter make(const ResultWriterOptions& options = {}) {
    return {folder, rig, Options(), 25, options};
  }
  std::set<std::string> contents() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) names.insert(fs::relative(entry.path(), folder).string());
    }
    return names;
  }
  std::string text(const char* name) const {
    std::ostringstream stream;
    stream << std::ifstream(folder / name).rdbuf();
    return stream.str();
  }

  TemporaryFolder temporary;
  fs::path folder = temporary.path() / "results";
  Rig rig;
  FrameSet frame;
  DiminishedFrame result;
};

TEST_F(ResultWriterTest, WritesEverythingThatItPromises) {
  ResultWriter writer = make();
  writer.write_images(frame, result);
  writer.append(frame, result);
  writer.finish(false);
  EXPECT_EQ(contents(), (std::set<std::string>{"result/000007.png", "mask/000007.png",
                                               "reconstruction/000007.png", "provenance/000007.png",
                                               "frames.csv", "summary.json", "result.mp4"}));
  Image<Bgr> picture;
  copy_from(cv::imread((folder / "result/000007.png").string()), picture);
  EXPECT_EQ(picture, result.picture);
  Image<Bgra> reconstruction;
  copy_from(cv::imread((folder / "reconstruction/000007.png").string(), cv::IMREAD_UNCHANGED),
            reconstruction);
  EXPECT_EQ(reconstruction, result.reconstruction.color);
  EXPECT_EQ(read_indexed_png(folder / "provenance/000007.png"), result.provenance);
  cv::VideoCapture video((folder / "result.mp4").string());
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_COUNT), 1);
  EXPECT_EQ(video.get(cv::CAP_PROP_FPS), 25);

  const auto summary = nlohmann::json::parse(text("summary.json"));
  EXPECT_EQ(summary["complete"], true);
  EXPECT_EQ(summary["frames"], 1);
  EXPECT_EQ(summary["options"]["mask_margin_px"], Options().mask_margin_px);
  EXPECT_EQ(summary["messages"]["another"], 1);
}

TEST_F(ResultWriterTest, CsvRowsHaveACellForEveryColumn) {
  ResultWriter writer = make();
  writer.append(frame, result);
  result.report.skipped = true;
  writer.append(frame, result);
  // The reader complains of rows with more or fewer cells than the header.
  const auto rows = load_csv(folder / "frames.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("color_from_world_qw"), "1");
  EXPECT_EQ(rows[0].at("rgbd0_depth_from_world_tx"), "");
  EXPECT_EQ(rows[0].at("messages"), "a \"quoted\", message; another");
  EXPECT_EQ(rows[0].at("occluders"), "lamp: color rgbd0");
  EXPECT_EQ(rows[1].at("skipped"), "1");
}

TEST_F(ResultWriterTest, PreviewsAreInputAndResultSideBySide) {
  ResultWriter writer = make({.preview_only = true});
  writer.write_images(frame, result);
  writer.append(frame, result);
  writer.finish(false);
  EXPECT_EQ(contents(),
            (std::set<std::string>{"preview/000007.png", "frames.csv", "summary.json"}));
  const cv::Mat preview = cv::imread((folder / "preview/000007.png").string());
  ASSERT_EQ(preview.cols, 2 * rig.color.width);
  EXPECT_EQ(preview.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(preview.at<cv::Vec3b>(0, rig.color.width), cv::Vec3b(40, 50, 60));
}

TEST_F(ResultWriterTest, OnlyForceReplacesAndThenOnlyResults) {
  {
    ResultWriter writer = make();
    writer.write_images(frame, result);
  }
  std::ofstream(folder / "notes.txt") << "mine";
  EXPECT_THROW(make(), Error);
  EXPECT_TRUE(fs::exists(folder / "result/000007.png"));
  make({.force = true});
  EXPECT_FALSE(fs::exists(folder / "result/000007.png"));
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
}

TEST_F(ResultWriterTest, AnInterruptedRunLeavesWholeFilesOnly) {
  {
    ResultWriter writer = make();
    writer.write_images(frame, result);
    writer.append(frame, result);
    writer.finish(true);
  }
  EXPECT_EQ(nlohmann::json::parse(text("summary.json"))["complete"], false);
  {
    // Ended by an error: neither `finish` nor the end of the video.
    ResultWriter writer = make({.force = true});
    writer.append(frame, result);
  }
  EXPECT_EQ(contents(), std::set<std::string>{"frames.csv"});
}

TEST_F(ResultWriterTest, AFolderThatCannotBeMadeIsAnError) {
  std::ofstream(folder) << "a file";
  EXPECT_THROW(make(), Error);
  folder = "/proc/nowhere";
  EXPECT_THROW(make(), Error);
}

}  // namespace
}  // namespace diminish

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <exception>
#include <map>
#include <random>
#include <string>

#include "core/text.h"
#include "diminish/error.h"
#include "diminish/pipeline.h"
#include "source/tiny_recording.h"

namespace diminish {
namespace {

using Files = std::map<std::string, std::string>;  ///< by name

/// A recording with images of three formats, given masks and fixed poses.
Files whole_recording() {
  const TinyRecording recording;
  recording.write("rig.yaml",
                  TinyRecording::rig() +
                      "pose: {source: fixed, color_from_rgbd: {rgbd0: {rotation: [1, 0, 0, 0, 1, 0,"
                      " 0, 0, 1], translation: [0.05, 0, 0]}}}\n");
  recording.write("scene.yaml",
                  "occluders:\n"
                  "  - {name: thing, detector: mask, color: masks}\n"
                  "  - {name: zone, detector: box, frame: rgbd0, min: [-1, -1, 0.3],"
                  " max: [0, 0, 2]}\n");
  std::mt19937 random(3);
  std::map<std::string, std::string> lists;
  for (int i = 0; i < 3; ++i) {
    cv::Mat picture(30, 40, CV_8UC3);
    cv::Mat seen(24, 32, CV_8UC3);
    for (cv::Mat image : {picture, seen}) {
      std::generate_n(image.data, image.total() * 3, [&] { return random() % 256; });
    }
    cv::Mat mask(30, 40, CV_8UC1, cv::Scalar(0));
    mask(cv::Rect(10, 8, 12, 9)) = 255;
    recording.write(fmt::format("color/{}.jpg", i), picture);
    recording.write(fmt::format("rgbd0_color/{}.ppm", i), seen);
    recording.write(fmt::format("masks/{}.png", i), mask);
    lists["color.txt"] += fmt::format("{} color/{}.jpg\n", 1 + 0.1 * i, i);
    lists["rgbd0_color.txt"] += fmt::format("{} rgbd0_color/{}.ppm\n", 1.001 + 0.1 * i, i);
    lists["rgbd0_depth.txt"] += fmt::format("{} rgbd0_depth/{}.png\n", 1.002 + 0.1 * i, i);
    std::filesystem::remove(recording.path(fmt::format("color/{}.png", i)));
    std::filesystem::remove(recording.path(fmt::format("rgbd0_color/{}.png", i)));
  }
  for (const auto& [name, list] : lists) recording.write(name, list);

  Files files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(recording.path(""))) {
    if (!entry.is_regular_file()) continue;
    const std::string name = std::filesystem::relative(entry.path(), recording.path("")).string();
    files[name] = read_text_file(entry.path(), 1 << 20);
  }
  return files;
}

/// What disks, copies and people do to a recording.
class Damage {
 public:
  explicit Damage(unsigned seed) : random_(seed) {}

  void apply_to(Files& files) {
    for (std::size_t count = 1 + below(3); count > 0; --count) damage(files);
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }
  std::string& any(Files& files) {
    return std::next(files.begin(), static_cast<std::ptrdiff_t>(below(files.size())))->second;
  }
  /// Of the files that people edit, which nearly all others outnumber.
  std::string& any_text(Files& files) {
    constexpr std::array names = {"rig.yaml", "scene.yaml", "color.txt", "rgbd0_color.txt",
                                  "rgbd0_depth.txt"};
    return files[names[below(names.size())]];
  }

  void damage(Files& files) {
    std::string& file = any(files);
    std::string& text = any_text(files);
    switch (below(8)) {
      case 0:
        for (int i = 0; i < 4 && !file.empty(); ++i) {
          file[below(file.size())] = static_cast<char>(random_());
        }
        break;
      case 1:
        file.resize(below(file.size() + 1));
        break;
      case 2:
        files.erase(std::next(files.begin(), static_cast<std::ptrdiff_t>(below(files.size()))));
        break;
      case 3:
        std::swap(file, any(files));
        break;
      case 4:
        change_number(text);
        break;
      case 5:
        file.insert(below(file.size() + 1), file.substr(0, below(64)));
        break;
      case 6:
        text.resize(below(text.size() + 1));
        break;
      default:
        change_number(text);
        change_number(text);
    }
  }

  void change_number(std::string& text) {
    constexpr const char* digits = "0123456789";
    constexpr std::array numbers = {"nan", "-1", "0", "1e308", "inf", "4294967296", "1e-320", "7"};
    const std::size_t begin = text.find_first_of(digits, below(text.size() + 1));
    if (begin == std::string::npos) return;
    const std::size_t end = std::min(text.find_first_not_of("0123456789.", begin), text.size());
    text.replace(begin, end - begin, numbers[below(numbers.size())]);
  }

  std::mt19937 random_;
};

void expect_one_line(const std::string& text) {
  EXPECT_FALSE(text.empty());
  EXPECT_TRUE(std::none_of(text.begin(), text.end(), [](char c) {
    return std::iscntrl(static_cast<unsigned char>(c)) != 0;
  })) << text;
}

/// Whether it could be run: all its frames. Otherwise it was an Error of one line.
bool runs(const std::filesystem::path& folder) {
  try {
    const Recording recording = load_recording(folder);
    const auto source = open_recording(recording, Options{});
    Pipeline pipeline(recording.rig, recording.scene, {});
    FrameSet frame;
    DiminishedFrame result;
    while (source->next(frame)) {
      pipeline.process(frame, result);
      for (const std::string& fault : frame.faults) expect_one_line(fault);
      if (result.report.skipped) continue;  // its colour image is missing
      EXPECT_EQ(result.picture.width(), recording.rig.color.width);
      EXPECT_EQ(result.picture.height(), recording.rig.color.height);
    }
    return true;
  } catch (const Error& error) {
    expect_one_line(error.what());
    EXPECT_NE(std::string(error.what()).find(folder.string()), std::string::npos)
        << "which file? " << error.what();
    return false;
  }
}

TEST(RecordingMutations, AreFramesOrOneClearLine) {
  const Files whole = whole_recording();
  int run = 0;
  int refused = 0;
  for (unsigned seed = 0; seed < 250; ++seed) {
    SCOPED_TRACE(seed);
    Files files = whole;
    if (seed > 0) Damage(seed).apply_to(files);
    const TemporaryFolder folder;
    for (const auto& [name, content] : files) folder.write(name, content);
    ::testing::internal::CaptureStderr();
    try {
      ++(runs(folder.path()) ? run : refused);
    } catch (const std::exception& error) {
      ADD_FAILURE() << "not an Error: " << error.what();
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "")
        << "libraries say nothing by themselves";
    ASSERT_GE(run, 1) << "unchanged, it runs";
  }
  EXPECT_GT(run, 50);
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace diminish

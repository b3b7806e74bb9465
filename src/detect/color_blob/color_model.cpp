#include "detect/color_blob/color_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fstream>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <system_error>
#include <vector>

#include "diminish/config.h"
#include "diminish/error.h"
#include "diminish/image.h"
#include "source/image_file.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;
constexpr double degrees = 180 / std::numbers::pi;

/// A colour in the HSV cone: the angle of `chroma` is the hue, its length is max - min.
struct Hsv {
  std::complex<double> chroma;
  double saturation;
  double value;
};

Hsv to_hsv(const Eigen::Vector3d& bgr) {
  const auto [blue, green, red] = std::array{bgr[0] / 255, bgr[1] / 255, bgr[2] / 255};
  const double value = std::max({blue, green, red});
  const double chroma = value - std::min({blue, green, red});
  if (chroma <= 0) return {0, 0, value};
  const double sixths = value == red     ? (green - blue) / chroma
                        : value == green ? (blue - red) / chroma + 2
                                         : (red - green) / chroma + 4;
  return {std::polar(chroma, sixths * std::numbers::pi / 3), chroma / value, value};
}

/// Mean and standard deviation of what is added.
class Distribution {
 public:
  void add(double x) {
    ++count_;
    sum_ += x;
    squares_ += x * x;
  }
  double mean() const { return sum_ / count_; }
  double spread() const { return std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean())); }

 private:
  double count_ = 0;
  double sum_ = 0;
  double squares_ = 0;
};

struct Statistics {
  std::complex<double> chroma = 0;
  double chroma_length = 0;
  Distribution saturation;
  Distribution value;
  double smallest_area = 1;
};

cv::Mat read_image(const fs::path& file) {
  try {
    return decode<Bgr>(read_bytes(file));
  } catch (const Error& error) {
    throw Error(Error::input, file.string() + ": expected an image: " + error.what());
  }
}

void add_image(const fs::path& file, Statistics& statistics) {
  const fs::path mask_file = file.parent_path() / (file.stem().string() + "_mask.png");
  if (!fs::exists(mask_file)) {
    throw Error(Error::input, mask_file.string() + ": expected the mask of " +
                                  file.filename().string() + ", there is no such file");
  }
  const cv::Mat image = read_image(file);
  cv::Mat mask;
  cv::cvtColor(read_image(mask_file), mask, cv::COLOR_BGR2GRAY);
  if (mask.size() != image.size()) {
    throw Error(Error::input, fmt::format("{}: expected {}'s size {} x {}, got {} x {}",
                                          mask_file.string(), file.filename().string(), image.cols,
                                          image.rows, mask.cols, mask.rows));
  }
  mask = mask > 127;
  const int area = cv::countNonZero(mask);
  if (area == 0)
    throw Error(Error::input, mask_file.string() + ": expected pixels of 255 on the object");
  statistics.smallest_area =
      std::min(statistics.smallest_area, area / static_cast<double>(image.total()));

  // The outline's pixels are mixed with the background.
  cv::Mat inner;
  cv::erode(mask, inner, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  if (cv::countNonZero(inner) > 0) mask = inner;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      if (mask.at<std::uint8_t>(y, x) == 0) continue;
      const auto& pixel = image.at<cv::Vec3b>(y, x);
      const Hsv hsv = to_hsv({double(pixel[0]), double(pixel[1]), double(pixel[2])});
      statistics.chroma += hsv.chroma;
      statistics.chroma_length += std::abs(hsv.chroma);
      statistics.saturation.add(hsv.saturation);
      statistics.value.add(hsv.value);
    }
  }
}

std::vector<fs::path> training_images(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string extension = entry.path().extension().string();
    const bool image =
        extension == ".jpg" || extension == ".jpeg" || extension == ".png" || extension == ".bmp";
    if (image && !entry.path().stem().string().ends_with("_mask")) files.push_back(entry.path());
  }
  if (error || files.empty()) {
    throw Error(Error::input,
                folder.string() + ": expected training images NAME.jpg with NAME_mask.png");
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool newer_than_images(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  const auto written = fs::last_write_time(file, error);
  if (error) return false;
  // The folder's own time changes when images are added or taken away, and also when the model is
  // written; so only the files' times count.
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path() != file && entry.last_write_time(error) > written) return false;
  }
  return true;
}

ColorModel read_color_model(const fs::path& file) {
  const Config config = Config::load(file);
  config.expect_keys({"hue_deg", "hue_spread_deg", "saturation", "saturation_spread", "value",
                      "value_spread", "smallest_area"});
  ColorModel model;
  model.hue_deg = config.at("hue_deg").number();
  model.hue_spread_deg = config.at("hue_spread_deg").number();
  model.saturation = config.at("saturation").number();
  model.saturation_spread = config.at("saturation_spread").number();
  model.value = config.at("value").number();
  model.value_spread = config.at("value_spread").number();
  model.smallest_area = config.at("smallest_area").number();
  return model;
}

}  // namespace

ColorDeviation ColorModel::deviation(const Eigen::Vector3d& bgr) const {
  // A few even training images must not make the distribution narrower than what noise and JPEG do
  // to a colour. Near grey, the same noise turns the hue further.
  constexpr double smallest_chroma_spread = 0.05;
  const double smallest_hue_spread_deg =
      smallest_chroma_spread / std::max(saturation, 1e-3) * degrees;
  // Brightness is the light's as much as the object's; only for a grey object it is all there is.
  const double smallest_value_spread = 0.1 + 0.15 * saturation;

  const Hsv hsv = to_hsv(bgr);
  const double hue_difference_deg =
      std::abs(std::remainder(std::arg(hsv.chroma) * degrees - hue_deg, 360));
  return {std::max(hue_difference_deg / std::max(hue_spread_deg, smallest_hue_spread_deg),
                   std::abs(hsv.saturation - saturation) /
                       std::max(saturation_spread, smallest_chroma_spread)),
          std::abs(hsv.value - value) / std::max(value_spread, smallest_value_spread)};
}

ColorModel train_color_model(const fs::path& folder) {
  Statistics statistics;
  for (const fs::path& file : training_images(folder)) add_image(file, statistics);

  ColorModel model;
  // The circular standard deviation, sqrt(-2 ln R); the wider, the more hues there are.
  const double concentration =
      statistics.chroma_length > 0 ? std::abs(statistics.chroma) / statistics.chroma_length : 0;
  model.hue_deg = std::arg(statistics.chroma) * degrees;
  model.hue_spread_deg =
      std::min(180.0, std::sqrt(-2 * std::log(std::clamp(concentration, 1e-9, 1.0))) * degrees);
  model.saturation = statistics.saturation.mean();
  model.saturation_spread = statistics.saturation.spread();
  model.value = statistics.value.mean();
  model.value_spread = statistics.value.spread();
  model.smallest_area = statistics.smallest_area;
  return model;
}

fs::path color_model_file(const fs::path& folder) {
  return folder / "color_model.yaml";
}

bool save_color_model(const ColorModel& model, const fs::path& file) {
  // Written beside and renamed, so that another process never reads half a file.
  const fs::path temporary =
      file.string() + fmt::format(".{:08x}", static_cast<unsigned>(std::random_device{}()));
  bool written = false;
  {
    std::ofstream stream(temporary);
    stream << fmt::format(
        "# The colour of the object in the images beside this file. Made from them; made again "
        "when they change.\n"
        "hue_deg: {}\nhue_spread_deg: {}\nsaturation: {}\nsaturation_spread: {}\nvalue: {}\n"
        "value_spread: {}\nsmallest_area: {}\n",
        model.hue_deg, model.hue_spread_deg, model.saturation, model.saturation_spread, model.value,
        model.value_spread, model.smallest_area);
    written = bool(stream.flush());
  }
  std::error_code error;
  if (written) fs::rename(temporary, file, error);
  if (!written || error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return false;
  }
  return true;
}

ColorModel load_color_model(const fs::path& folder) {
  const fs::path file = color_model_file(folder);
  if (newer_than_images(file, folder)) return read_color_model(file);
  const ColorModel model = train_color_model(folder);
  save_color_model(model, file);
  return model;
}

fs::path training_folder(const fs::path& training, const std::string& camera) {
  const fs::path own = training / camera;
  return fs::is_directory(own) ? own : training / "color";
}

}  // namespace diminish

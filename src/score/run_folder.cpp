#include "score/run_folder.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>

#include "core/mat.h"
#include "core/text.h"
#include "diminish/error.h"
#include "score/csv_table.h"
#include "sink/indexed_png.h"
#include "source/image_file.h"
#include "source/stream_list.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;

cv::Mat read_image(const fs::path& file) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return {};
  try {
    return decode<Bgr>(read_bytes(file));
  } catch (const Error& error) {
    throw Error(Error::input, file.string() + ": expected an image: " + error.what());
  }
}

cv::Mat read_mask(const fs::path& file) {
  cv::Mat mask = read_image(file);
  if (!mask.empty()) cv::cvtColor(mask, mask, cv::COLOR_BGR2GRAY);
  return mask;
}

nlohmann::json read_json(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Error(Error::io, file.string() + ": cannot be read, expected JSON");
  try {
    return nlohmann::json::parse(stream);
  } catch (const nlohmann::json::exception& error) {
    throw Error(Error::input, file.string() + ": " + printable(error.what()));
  }
}

/// The pose in the columns that begin with `name`; nothing where they are empty.
std::optional<RigidTransform> read_pose(const CsvRow& row, const std::string& name) {
  double v[7] = {};
  int i = 0;
  for (const char* part : {"tx", "ty", "tz", "qx", "qy", "qz", "qw"}) {
    const auto cell = row.find(name + "_" + part);
    if (cell == row.end()) return std::nullopt;
    const auto number = parse_number(cell->second);
    if (!number) return std::nullopt;
    v[i++] = *number;
  }
  return RigidTransform{Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized().matrix(),
                        {v[0], v[1], v[2]}};
}

RigidTransform read_matrix(const nlohmann::json& rows) {
  RigidTransform transform;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      transform.rotation(row, column) = rows.at(row).at(column);
    }
    transform.translation[row] = rows.at(row).at(3);
  }
  return transform;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

RunFolder::RunFolder(fs::path recording, fs::path run)
    : recording_(std::move(recording)), run_(std::move(run)) {
  const fs::path background = recording_ / "truth" / "background";
  if (!fs::is_directory(background)) {
    throw Error(Error::input,
                background.string() + ": not found, expected the true pictures to compare with");
  }
  read_frames();
  read_summary();
  read_true_poses();
  read_inputs();
}

void RunFolder::read_frames() {
  std::set<std::string> written;
  for (const CsvRow& row : load_csv(run_ / "frames.csv")) {
    const auto name = row.find("name");
    const auto skipped = row.find("skipped");
    if (name == row.end() || skipped == row.end()) {
      throw Error(Error::input,
                  (run_ / "frames.csv").string() + ": expected the columns name and skipped");
    }
    frames_.push_back(name->second);
    written.insert(name->second);
    NamedPoses& poses = poses_[name->second];
    for (const auto& [column, cell] : row) {
      if (!ends_with(column, "_tx")) continue;
      const std::string pose_name = column.substr(0, column.size() - 3);
      if (const auto pose = read_pose(row, pose_name)) poses[pose_name] = *pose;
    }
  }
  for (const auto& entry : fs::directory_iterator(recording_ / "truth" / "background")) {
    const std::string stem = entry.path().stem().string();
    if (written.count(stem) == 0) not_written_.push_back(stem);
  }
  std::sort(not_written_.begin(), not_written_.end());
}

void RunFolder::read_summary() {
  const fs::path file = run_ / "summary.json";
  try {
    mask_margin_px_ = read_json(file).at("options").at("mask_margin_px");
  } catch (const nlohmann::json::exception&) {
    throw Error(Error::input, file.string() + ": options.mask_margin_px: expected a number");
  }
}

void RunFolder::read_true_poses() {
  const fs::path file = recording_ / "truth" / "poses.json";
  if (!fs::exists(file)) return;
  try {
    for (const auto& frame : read_json(file)) {
      NamedPoses& poses = true_poses_[frame.at("frame")];
      for (const auto& [key, value] : frame.items()) {
        if (ends_with(key, "_from_world")) poses[key] = read_matrix(value);
      }
      const auto color = poses.find("color_from_world");
      if (color == poses.end()) continue;
      const RigidTransform color_from_world = color->second;
      const std::string suffix = "_depth_from_world";
      NamedPoses chained;
      for (const auto& [name, pose] : poses) {
        if (!ends_with(name, suffix)) continue;
        const std::string camera = name.substr(0, name.size() - suffix.size());
        chained["color_from_" + camera + "_depth"] = color_from_world * pose.inverse();
      }
      poses.merge(chained);
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(Error::input,
                file.string() + ": expected poses as 3x4 matrices: " + printable(error.what()));
  }
}

void RunFolder::read_inputs() {
  const fs::path list = recording_ / "color.txt";
  std::ifstream stream(list);
  if (!stream)
    throw Error(Error::io, list.string() + ": cannot be read, expected the colour images' list");
  for (const StreamEntry& entry : read_stream_list(stream, list)) {
    // A video's frames are not decoded again: of those the input is unknown here.
    if (!is_video(entry.file)) inputs_[entry.file.stem().string()] = recording_ / entry.file;
  }
}

fs::path RunFolder::find(const fs::path& folder, const std::string& stem) const {
  for (const char* extension : {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff"}) {
    const fs::path file = folder / (stem + extension);
    if (fs::exists(file)) return file;
  }
  return {};
}

cv::Mat RunFolder::input(const std::string& frame) const {
  const auto found = inputs_.find(frame);
  return found == inputs_.end() ? cv::Mat() : read_image(found->second);
}
cv::Mat RunFolder::truth(const std::string& frame) const {
  return read_image(find(recording_ / "truth" / "background", frame));
}
cv::Mat RunFolder::true_mask(const std::string& frame) const {
  return read_mask(find(recording_ / "truth" / "mask", frame));
}
cv::Mat RunFolder::result(const std::string& frame) const {
  return read_image(run_ / "result" / (frame + ".png"));
}
cv::Mat RunFolder::mask(const std::string& frame) const {
  return read_mask(run_ / "mask" / (frame + ".png"));
}
cv::Rect RunFolder::surroundings(const cv::Mat& mask) {
  constexpr int margin_px = 40;
  const cv::Rect bounds(0, 0, mask.cols, mask.rows);
  const cv::Rect object = cv::boundingRect(mask);
  if (object.empty()) return bounds;
  return cv::Rect(object.x - margin_px, object.y - margin_px, object.width + 2 * margin_px,
                  object.height + 2 * margin_px) &
         bounds;
}

std::optional<RunFolder::ObjectPictures> RunFolder::object_pictures(
    const std::string& frame) const {
  const ObjectPictures whole{input(frame), result(frame), truth(frame)};
  const cv::Mat object = mask(frame);
  if (whole.input.empty() || whole.result.empty() || whole.truth.empty() || object.empty()) {
    return std::nullopt;
  }
  const cv::Rect part = surroundings(object);
  return ObjectPictures{whole.input(part), whole.result(part), whole.truth(part)};
}

cv::Mat RunFolder::provenance(const std::string& frame) const {
  const fs::path file = run_ / "provenance" / (frame + ".png");
  if (!fs::exists(file)) return {};
  const Image<std::uint8_t> indices = read_indexed_png(file);
  return as_mat(indices).clone();
}

RunFolder::NamedPoses RunFolder::poses(const std::string& frame) const {
  const auto found = poses_.find(frame);
  return found == poses_.end() ? NamedPoses() : found->second;
}
RunFolder::NamedPoses RunFolder::true_poses(const std::string& frame) const {
  const auto found = true_poses_.find(frame);
  return found == true_poses_.end() ? NamedPoses() : found->second;
}

}  // namespace diminish

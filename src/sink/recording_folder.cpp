#include "sink/recording_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <system_error>
#include <type_traits>

#include "core/mat.h"
#include "diminish/error.h"
#include "sink/partial_file.h"
#include "sink/pose_line.h"

namespace diminish {
namespace {

constexpr int jpeg_quality = 95;
/// Between two frames, where their timestamps do not tell.
constexpr double usual_period_s = 1.0 / 30;

bool are_equal(const ImageView<Bgr>& a, const ImageView<Bgr>& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  for (int y = 0; y < a.height(); ++y) {
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  }
  return true;
}

}  // namespace

void make_recording_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error)) {
    throw Error(Error::io,
                folder.string() + ": expected an empty folder for the recording, or none");
  }
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(Error::io, folder.string() + ": cannot be made: " + error.message());
}

void copy_to(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::create_directories(to.parent_path(), error);
  std::filesystem::copy(from, to, std::filesystem::copy_options::recursive, error);
  if (error) throw Error(Error::io, from.string() + ": cannot be copied: " + error.message());
}

RecordingFolder::RecordingFolder(std::filesystem::path folder, const Rig& rig,
                                 const std::filesystem::path& scene_file, const Scene& scene,
                                 Pictures pictures)
    : folder_(std::move(folder)), scene_file_(scene_file), pictures_(pictures) {
  make_recording_folder(folder_);
  copy_to(scene_file, folder_ / "scene.yaml");
  std::set<std::filesystem::path> named;
  for (const OccluderSpec& occluder : scene.occluders) {
    if (!occluder.settings) continue;
    for (const std::filesystem::path& path : occluder.settings->files()) named.insert(path);
  }
  for (const std::filesystem::path& path : named) copy_to(path, place_of(path));
  color_ = make_stream("color", "color");
  for (const RgbdCamera& camera : rig.rgbd) {
    rgbd_color_.push_back(make_stream(camera.name + "_color", camera.name + "/color"));
    rgbd_depth_.emplace_back();
    if (!camera.measures_depth) continue;
    rgbd_depth_.back() = make_stream(camera.name + "_depth", camera.name + "/depth");
  }
}

std::filesystem::path RecordingFolder::place_of(const std::filesystem::path& named) const {
  const std::filesystem::path relative =
      named.lexically_normal().lexically_relative(scene_file_.parent_path().lexically_normal());
  if (relative.empty() || *relative.begin() == "..") {
    throw Error(scene_file_.string() + ": " + named.string() +
                ": expected a path inside the file's folder, so that a recording can hold it");
  }
  return folder_ / relative;
}

RecordingFolder::Stream RecordingFolder::make_stream(const std::string& list,
                                                     const std::string& folder) const {
  std::error_code error;
  std::filesystem::create_directories(folder_ / folder, error);
  if (error)
    throw Error(Error::io, (folder_ / folder).string() + ": cannot be made: " + error.message());
  Stream stream;
  stream.folder = folder;
  stream.list_file = folder_ / (list + ".txt");
  stream.list.open(stream.list_file);
  append(stream, "# timestamp filename\n");
  return stream;
}

void RecordingFolder::follow_clock(double stamp_s) {
  if (stamp_s + clock_shift_s_ >= color_.last_stamp_s) return;
  clock_shift_s_ = color_.last_stamp_s + usual_period_s - stamp_s;
}

bool RecordingFolder::write(const FrameSet& frame, const std::string& name) {
  follow_clock(frame.stamp_s);
  if (frame.stamp_s + clock_shift_s_ <= color_.last_stamp_s) return false;
  for (std::size_t k = 0; k < frame.rgbd.size(); ++k) {
    const RgbdFrame& rgbd = frame.rgbd[k];
    if (!rgbd_depth_[k] ? !rgbd.has_picture() : !rgbd.available()) continue;
    if (are_equal(rgbd.color, frame.color)) {
      add(rgbd_color_[k], rgbd.color_stamp_s + clock_shift_s_, file_of(color_, name, true));
    } else {
      write_image(rgbd_color_[k], rgbd.color, rgbd.color_stamp_s + clock_shift_s_, name);
    }
    if (rgbd_depth_[k])
      write_image(*rgbd_depth_[k], rgbd.depth, rgbd.depth_stamp_s + clock_shift_s_, name);
  }
  write_image(color_, frame.color, frame.stamp_s + clock_shift_s_, name);
  return true;
}

std::string RecordingFolder::file_of(const Stream& stream, const std::string& name,
                                     bool is_color) const {
  return stream.folder + "/" + name + extension(is_color);
}

template <class Pixel>
void RecordingFolder::write_image(Stream& stream, const InputImage<Pixel>& image, double stamp_s,
                                  const std::string& name) {
  // Two frames may share an RGB-D image.
  if (stamp_s <= stream.last_stamp_s) return;
  constexpr bool is_color = std::is_same_v<Pixel, Bgr>;
  const std::string file = file_of(stream, name, is_color);
  const bool is_jpeg = is_color && pictures_ == Pictures::jpeg;
  const std::vector<int> parameters = is_jpeg
                                          ? std::vector<int>{cv::IMWRITE_JPEG_QUALITY, jpeg_quality}
                                          : std::vector<int>{};  // without a level, as in write_png
  if (!cv::imencode(extension(is_color), as_mat(image), bytes_, parameters)) {
    throw Error(Error::io, (folder_ / file).string() + ": cannot be encoded");
  }
  write_file(folder_ / file, {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()});
  add(stream, stamp_s, file);
}

std::string RecordingFolder::keep_poses(const Rig& rig) {
  std::string files;
  const auto begin = [&](const std::string& camera) {
    Stream& list = pose_lists_.emplace_back();
    const std::string name = camera + "_poses.txt";
    list.list_file = folder_ / name;
    list.list.open(list.list_file);
    append(list, pose_list_head);
    files += fmt::format("{}{}: {}", files.empty() ? "" : ", ", camera, name);
  };
  begin("color");
  for (const RgbdCamera& camera : rig.rgbd) {
    begin(camera.name);
    posed_from_depth_.push_back(camera.depth_from_posed.inverse());
  }
  return "{source: file, files: {" + files + "}}";
}

void RecordingFolder::add_poses(const FrameSet& frame, const Poses& poses) {
  if (poses.color_from_world) add_pose(pose_lists_[0], frame.stamp_s, *poses.color_from_world);
  for (std::size_t k = 0; k < poses.depth_from_world.size(); ++k) {
    const auto& depth_from_world = poses.depth_from_world[k];
    if (!depth_from_world || frame.rgbd[k].depth.empty()) continue;
    add_pose(pose_lists_[1 + k], frame.rgbd[k].depth_stamp_s,
             posed_from_depth_[k] * *depth_from_world);
  }
}

void RecordingFolder::add_pose(Stream& list, double stamp_s,
                               const RigidTransform& camera_from_world) {
  stamp_s += clock_shift_s_;
  if (stamp_s <= list.last_stamp_s) return;  // two frames may share an image
  append(list, pose_line(stamp_s, camera_from_world));
  list.last_stamp_s = stamp_s;
}

void RecordingFolder::append(Stream& stream, const std::string& line) {
  stream.list << line << std::flush;
  if (stream.list) {
    stream.list_bytes += line.size();
    return;
  }
  // A full disk may have taken a part of it.
  stream.list.close();
  std::error_code ignored;
  std::filesystem::resize_file(stream.list_file, stream.list_bytes, ignored);
  throw Error(Error::io, stream.list_file.string() + ": cannot be written");
}

void RecordingFolder::add(Stream& stream, double stamp_s, const std::string& file) {
  append(stream, fmt::format("{:.6f} {}\n", stamp_s, file));
  stream.last_stamp_s = stamp_s;
}

}  // namespace diminish

#include "diminish/recording_writer.h"

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <fstream>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <system_error>
#include <thread>
#include <type_traits>
#include <vector>

#include "core/mat.h"
#include "diminish/error.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

constexpr std::size_t most_waiting = 8;
constexpr int jpeg_quality = 95;

void make_folder(const std::filesystem::path& folder) {
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

/// Copies a file or folder that scene.yaml names to the same place beside the new scene.yaml.
void copy_named(const std::filesystem::path& named, const std::filesystem::path& scene_file,
                const std::filesystem::path& folder) {
  const std::filesystem::path relative =
      named.lexically_normal().lexically_relative(scene_file.parent_path().lexically_normal());
  if (relative.empty() || *relative.begin() == "..") {
    throw Error(scene_file.string() + ": " + named.string() +
                ": expected a path inside the file's folder, so that a recording can hold it");
  }
  copy_to(named, folder / relative);
}

/// A sensor's folder and list.
struct Stream {
  std::string folder;  ///< relative: "rgbd0/depth"
  std::ofstream list;
  double last_stamp_s = -1;
  std::size_t images = 0;
};

}  // namespace

struct RecordingWriter::Implementation {
  Implementation(std::filesystem::path folder, const std::filesystem::path& rig_file,
                 const Rig& rig, const std::filesystem::path& scene_file, const Scene& scene);

  Stream make_stream(const std::string& list, const std::string& folder) const;
  void offer(std::shared_ptr<const LiveFrame> frame);
  void finish();
  void work();
  void write(const LiveFrame& frame);
  template <class Pixel>
  void write_image(Stream& stream, const InputImage<Pixel>& image, double stamp_s);

  std::filesystem::path folder_;
  Stream color_;
  std::vector<Stream> rgbd_color_, rgbd_depth_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<const LiveFrame>> waiting_;
  RecordingStatus status_;
  bool ending_ = false;
  std::vector<std::uint8_t> bytes_;
  std::thread thread_;
};

RecordingWriter::Implementation::Implementation(std::filesystem::path folder,
                                                const std::filesystem::path& rig_file,
                                                const Rig& rig,
                                                const std::filesystem::path& scene_file,
                                                const Scene& scene)
    : folder_(std::move(folder)) {
  make_folder(folder_);
  copy_to(rig_file, folder_ / "rig.yaml");
  copy_to(scene_file, folder_ / "scene.yaml");
  std::set<std::filesystem::path> named;
  for (const OccluderSpec& occluder : scene.occluders) {
    if (!occluder.settings) continue;
    for (const std::filesystem::path& path : occluder.settings->files()) named.insert(path);
  }
  for (const std::filesystem::path& path : named) copy_named(path, scene_file, folder_);
  color_ = make_stream("color", "color");
  for (const RgbdCamera& camera : rig.rgbd) {
    rgbd_color_.push_back(make_stream(camera.name + "_color", camera.name + "/color"));
    rgbd_depth_.push_back(make_stream(camera.name + "_depth", camera.name + "/depth"));
  }
  status_.active = true;
  status_.folder = folder_.string();
  thread_ = std::thread([this] { work(); });
}

void RecordingWriter::Implementation::finish() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void RecordingWriter::Implementation::offer(std::shared_ptr<const LiveFrame> frame) {
  {
    const std::lock_guard lock(mutex_);
    if (ending_ || !status_.active) return;
    if (waiting_.size() >= most_waiting) {
      ++status_.dropped;
      return;
    }
    waiting_.push_back(std::move(frame));
  }
  changed_.notify_all();
}

Stream RecordingWriter::Implementation::make_stream(const std::string& list,
                                                    const std::string& folder) const {
  std::error_code error;
  std::filesystem::create_directories(folder_ / folder, error);
  if (error)
    throw Error(Error::io, (folder_ / folder).string() + ": cannot be made: " + error.message());
  const std::filesystem::path file = folder_ / (list + ".txt");
  Stream stream;
  stream.folder = folder;
  stream.list.open(file);
  stream.list << "# timestamp filename\n" << std::flush;
  if (!stream.list) throw Error(Error::io, file.string() + ": cannot be written");
  return stream;
}

void RecordingWriter::Implementation::work() {
  while (true) {
    std::shared_ptr<const LiveFrame> frame;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
      if (waiting_.empty()) break;
      frame = std::move(waiting_.front());
      waiting_.pop_front();
    }
    std::string problem;
    try {
      write(*frame);
    } catch (const std::exception& error) {
      problem = error.what();
    }
    const std::lock_guard lock(mutex_);
    if (problem.empty()) {
      ++status_.frames;
      continue;
    }
    status_.problem = problem;
    waiting_.clear();
    break;
  }
  const std::lock_guard lock(mutex_);
  status_.active = false;
}

void RecordingWriter::Implementation::write(const LiveFrame& frame) {
  const FrameSet& input = frame.input;
  for (std::size_t k = 0; k < input.rgbd.size(); ++k) {
    const RgbdFrame& rgbd = input.rgbd[k];
    if (!rgbd.available()) continue;
    write_image(rgbd_color_[k], rgbd.color, rgbd.color_stamp_s);
    write_image(rgbd_depth_[k], rgbd.depth, rgbd.depth_stamp_s);
  }
  write_image(color_, input.color, input.stamp_s);
}

template <class Pixel>
void RecordingWriter::Implementation::write_image(Stream& stream, const InputImage<Pixel>& image,
                                                  double stamp_s) {
  // Two frames may share an RGB-D image, and the timestamps in a list must increase.
  if (stamp_s <= stream.last_stamp_s) return;
  constexpr bool is_color = std::is_same_v<Pixel, Bgr>;
  const std::string name =
      fmt::format("{}/{:06}.{}", stream.folder, stream.images, is_color ? "jpg" : "png");
  const std::vector<int> parameters = is_color
                                          ? std::vector<int>{cv::IMWRITE_JPEG_QUALITY, jpeg_quality}
                                          : std::vector<int>{};  // without a level, as in write_png
  if (!cv::imencode(is_color ? ".jpg" : ".png", as_mat(image), bytes_, parameters)) {
    throw Error(Error::io, (folder_ / name).string() + ": cannot be encoded");
  }
  write_file(folder_ / name, {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()});
  stream.list << fmt::format("{:.6f} {}\n", stamp_s, name) << std::flush;
  if (!stream.list)
    throw Error(Error::io, (folder_ / stream.folder).string() + ": its list cannot be written");
  stream.last_stamp_s = stamp_s;
  ++stream.images;
}

RecordingWriter::RecordingWriter(std::filesystem::path folder,
                                 const std::filesystem::path& rig_file, const Rig& rig,
                                 const std::filesystem::path& scene_file, const Scene& scene)
    : implementation_(
          std::make_unique<Implementation>(std::move(folder), rig_file, rig, scene_file, scene)) {}

RecordingWriter::~RecordingWriter() {
  finish();
}

void RecordingWriter::offer(std::shared_ptr<const LiveFrame> frame) {
  implementation_->offer(std::move(frame));
}

RecordingStatus RecordingWriter::status() const {
  const std::lock_guard lock(implementation_->mutex_);
  return implementation_->status_;
}

void RecordingWriter::finish() {
  implementation_->finish();
}

}  // namespace diminish

#include <fmt/format.h>

#include <optional>
#include <system_error>
#include <unordered_map>

#include "core/tasks.h"
#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "diminish/validate.h"
#include "source/image_stream.h"
#include "source/mask_folders.h"

namespace diminish {
namespace {

/// The streams of one RGB-D camera.
struct RgbdStreams {
  ImageStream<Bgr> color;
  std::optional<ImageStream<std::uint16_t>> depth;  ///< if the camera measures it
};

/// Masks, results and truth know frames by name, so names must be unique.
void expect_unique_names(const std::vector<StreamEntry>& entries,
                         const std::filesystem::path& list) {
  std::unordered_map<std::string, int> lines;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string name = entry_name(entries[i], i);
    const auto [same, added] = lines.emplace(name, entries[i].line);
    if (added) continue;
    throw Error(Error::input,
                fmt::format("{}:{}: expected another name than '{}', which line {} has too",
                            list.string(), entries[i].line, name, same->second));
  }
}

class RecordingSource final : public FrameSource {
 public:
  RecordingSource(const Recording& recording, const Options& options)
      : rig_(recording.rig),
        masks_(find_mask_folders(recording.scene, recording.rig)),
        color_(recording.folder / "color.txt", recording.rig.color) {
    expect_unique_names(color_.entries(), recording.folder / "color.txt");
    for (const RgbdCamera& camera : rig_.rgbd) {
      const std::filesystem::path lists = recording.folder / camera.name;
      rgbd_.push_back({{lists.string() + "_color.txt", camera.color, EmptyList::is_no_images}, {}});
      if (!camera.measures_depth) continue;
      rgbd_.back().depth.emplace(lists.string() + "_depth.txt", camera.depth,
                                 EmptyList::is_no_images);
    }
    tolerance_s_ = options.sync_tolerance_s > 0 ? options.sync_tolerance_s
                                                : median_period_s(color_.entries()) / 2;
  }

  std::size_t frame_count() const override { return color_.entries().size(); }

  double frames_per_second() const override {
    const auto& entries = color_.entries();
    if (entries.size() < 2) return 0;
    return static_cast<double>(entries.size() - 1) /
           (entries.back().stamp_s - entries.front().stamp_s);
  }

  bool next(FrameSet& frame) override {
    if (!begin(frame)) return false;
    read_images(frame);
    return true;
  }

  bool begin(FrameSet& frame) override {
    if (next_ == frame_count()) return false;
    const StreamEntry& entry = color_.entries()[next_];
    frame.name = entry_name(entry, next_);
    frame.index = next_;
    frame.stamp_s = entry.stamp_s;
    frame.rgbd.resize(rgbd_.size());
    frame.faults.assign(1 + 2 * rgbd_.size(), "");
    read_sensors(Part::videos, frame);
    ++next_;
    return true;
  }

  void read_images(FrameSet& frame) override {
    read_sensors(Part::files, frame);
    std::vector<std::string> rgbd_names;
    for (std::size_t i = 0; i < rgbd_.size(); ++i) rgbd_names.push_back(describe_rgbd(i, frame));
    std::erase(frame.faults, "");
    frame.masks.resize(masks_.size());
    for (std::size_t i = 0; i < masks_.size(); ++i) {
      read_given_mask(masks_[i], rig_, rgbd_names, frame, frame.masks[i]);
    }
  }

 private:
  enum class Part { videos, files };

  template <class Pixel>
  std::optional<std::size_t> partner(const ImageStream<Pixel>& stream,
                                     const FrameSet& frame) const {
    return nearest_entry(stream.entries(), frame.stamp_s, tolerance_s_);
  }

  /// Reads the images of all sensors that are frames of videos, or files. The faults of sensor i
  /// become `faults[i]`: 0 is the colour camera, then come each RGB-D camera's two.
  void read_sensors(Part part, FrameSet& frame) {
    const auto read_sensor = [&](std::size_t sensor) {
      std::string& fault = frame.faults[sensor];
      if (sensor == 0) return read(color_, frame.index, part, frame.color.own(), fault);
      const std::size_t camera = (sensor - 1) / 2;
      RgbdStreams& streams = rgbd_[camera];
      RgbdFrame& rgbd = frame.rgbd[camera];
      if (sensor % 2 == 1) {
        read(streams.color, partner(streams.color, frame), part, rgbd.color.own(), fault);
      } else if (streams.depth) {
        read(*streams.depth, partner(*streams.depth, frame), part, rgbd.depth.own(), fault);
      }
    };
    for_tasks(frame.faults.size(), read_sensor);
  }

  template <class Pixel>
  static void read(ImageStream<Pixel>& stream, std::optional<std::size_t> index, Part part,
                   Image<Pixel>& image, std::string& fault) {
    if (!index) return image.resize(0, 0);
    if (stream.needs_order(*index) != (part == Part::videos)) return;
    try {
      stream.read(*index, image);
    } catch (const Error& error) {
      fault = error.what();
    }
  }

  /// When an RGB-D camera's images were taken, and what is missing. Returns the name of its colour
  /// image; empty if it has none.
  std::string describe_rgbd(std::size_t camera, FrameSet& frame) const {
    const RgbdStreams& streams = rgbd_[camera];
    RgbdFrame& rgbd = frame.rgbd[camera];
    const std::string* faults = &frame.faults[1 + 2 * camera];
    const auto color = partner(streams.color, frame);
    rgbd.color_stamp_s = color ? streams.color.entries()[*color].stamp_s : 0;
    // An estimated depth image is of the same moment.
    rgbd.depth_stamp_s = rgbd.color_stamp_s;
    rgbd.missing = problem_of(camera, "color", color, faults[0]);
    if (streams.depth) {
      const auto depth = partner(*streams.depth, frame);
      rgbd.depth_stamp_s = depth ? streams.depth->entries()[*depth].stamp_s : 0;
      if (rgbd.missing.empty()) rgbd.missing = problem_of(camera, "depth", depth, faults[1]);
    }
    return color ? entry_name(streams.color.entries()[*color], *color) : "";
  }

  std::string problem_of(std::size_t camera, const char* sensor, std::optional<std::size_t> image,
                         const std::string& fault) const {
    const std::string& name = rig_.rgbd[camera].name;
    if (!image) return fmt::format("{}: no {} image within {:.2g} s", name, sensor, tolerance_s_);
    if (!fault.empty()) return fmt::format("{}: its {} image cannot be used", name, sensor);
    return {};
  }

  Rig rig_;
  std::vector<MaskFolders> masks_;
  ImageStream<Bgr> color_;
  std::vector<RgbdStreams> rgbd_;
  double tolerance_s_ = 0;
  std::size_t next_ = 0;
};

}  // namespace

Recording load_recording(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw Error(Error::input, folder.string() + ": expected a recording's folder");
  }
  Recording recording{folder, load_rig(folder / "rig.yaml"), load_scene(folder / "scene.yaml")};
  validate(recording.scene, recording.rig);
  return recording;
}

std::unique_ptr<FrameSource> open_recording(const Recording& recording, const Options& options) {
  return std::make_unique<RecordingSource>(recording, options);
}

}  // namespace diminish

#include <fmt/format.h>

#include <optional>
#include <system_error>
#include <unordered_map>

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
  ImageStream<std::uint16_t> depth;
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
      rgbd_.push_back({{lists.string() + "_color.txt", camera.color, EmptyList::is_no_images},
                       {lists.string() + "_depth.txt", camera.depth, EmptyList::is_no_images}});
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
    if (next_ == frame_count()) return false;
    const StreamEntry& entry = color_.entries()[next_];
    frame.name = entry_name(entry, next_);
    frame.index = next_;
    frame.stamp_s = entry.stamp_s;
    frame.faults.clear();
    read(color_, next_, frame.color.own(), frame.faults);
    frame.rgbd.resize(rgbd_.size());
    std::vector<std::string> rgbd_names;
    for (std::size_t i = 0; i < rgbd_.size(); ++i) rgbd_names.push_back(read_rgbd(i, frame));
    frame.masks.resize(masks_.size());
    for (std::size_t i = 0; i < masks_.size(); ++i) {
      read_given_mask(masks_[i], rig_, rgbd_names, frame, frame.masks[i]);
    }
    ++next_;
    return true;
  }

 private:
  template <class Pixel>
  static bool read(ImageStream<Pixel>& stream, std::size_t index, Image<Pixel>& image,
                   std::vector<std::string>& faults) {
    try {
      stream.read(index, image);
      return true;
    } catch (const Error& error) {
      faults.push_back(error.what());
      return false;
    }
  }

  /// Returns the name of the camera's colour image; empty if it has none.
  std::string read_rgbd(std::size_t camera, FrameSet& frame) {
    RgbdFrame& rgbd = frame.rgbd[camera];
    RgbdStreams& streams = rgbd_[camera];
    rgbd.missing.clear();
    const auto color =
        read_partner(camera, "color", streams.color, frame, rgbd.color.own(), rgbd.color_stamp_s);
    read_partner(camera, "depth", streams.depth, frame, rgbd.depth.own(), rgbd.depth_stamp_s);
    return color ? entry_name(streams.color.entries()[*color], *color) : "";
  }

  /// Reads the image of an RGB-D camera's sensor that goes with the frame; returns which one it is.
  template <class Pixel>
  std::optional<std::size_t> read_partner(std::size_t camera, const char* sensor,
                                          ImageStream<Pixel>& stream, FrameSet& frame,
                                          Image<Pixel>& image, double& stamp_s) {
    std::string& missing = frame.rgbd[camera].missing;
    const auto partner = nearest_entry(stream.entries(), frame.stamp_s, tolerance_s_);
    const std::string& name = rig_.rgbd[camera].name;
    std::string reason;
    if (!partner) {
      image.resize(0, 0);
      stamp_s = 0;
      reason = fmt::format("{}: no {} image within {:.2g} s", name, sensor, tolerance_s_);
    } else {
      stamp_s = stream.entries()[*partner].stamp_s;
      if (!read(stream, *partner, image, frame.faults)) {
        reason = fmt::format("{}: its {} image cannot be used", name, sensor);
      }
    }
    if (missing.empty()) missing = reason;
    return partner;
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

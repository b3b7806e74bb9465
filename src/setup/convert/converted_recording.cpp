#include "setup/convert/converted_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <system_error>
#include <vector>

#include "core/mat.h"
#include "diminish/error.h"
#include "sink/partial_file.h"
#include "source/rig_yaml.h"

namespace diminish {
namespace {

constexpr int jpeg_quality = 95;

std::string_view as_text(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

ConvertedStream::ConvertedStream(const std::filesystem::path& recording, const std::string& name)
    : recording_(recording), folder_(name) {
  const std::size_t underscore = folder_.rfind('_');
  if (underscore != std::string::npos) folder_[underscore] = '/';
  std::error_code error;
  std::filesystem::create_directories(recording_ / folder_, error);
  const std::filesystem::path list = recording_ / (name + ".txt");
  list_.open(list);
  list_ << "# timestamp filename\n";
  if (error || !list_) throw Error(Error::io, list.string() + ": cannot be written");
}

bool ConvertedStream::add(double stamp_s, std::string_view bytes, const char* extension) {
  if (stamp_s <= last_stamp_s_) return false;
  const std::string file = fmt::format("{}/{:06}{}", folder_, images_, extension);
  write_file(recording_ / file, bytes);
  return add_file(stamp_s, file);
}

bool ConvertedStream::add(double stamp_s, const Image<Bgr>& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", as_mat(image), bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
  return add(stamp_s, as_text(bytes), ".jpg");
}

bool ConvertedStream::add(double stamp_s, const Image<std::uint16_t>& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", as_mat(image), bytes);
  return add(stamp_s, as_text(bytes), ".png");
}

bool ConvertedStream::add_file(double stamp_s, const std::string& file) {
  if (stamp_s <= last_stamp_s_) return false;
  list_ << fmt::format("{:.6f} {}\n", stamp_s, file) << std::flush;
  if (!list_)
    throw Error(Error::io, (recording_ / folder_).string() + ": its list cannot be written");
  last_stamp_s_ = stamp_s;
  last_file_ = file;
  ++images_;
  return true;
}

void write_set_up(const std::filesystem::path& folder, const Rig& rig, bool is_first,
                  const std::string& notes) {
  std::string pose = "{source: marker}";
  if (is_first && rig.rgbd.size() == 1) {
    pose = fmt::format("{{source: fixed, color_from_rgbd: {{{}: {}}}}}", rig.rgbd[0].name,
                       as_yaml(rig.rgbd[0].color_from_depth));
  }
  write_file(folder / "rig.yaml", "# Made by `diminish convert`.\n" + notes + as_yaml(rig, pose));
  std::string scene = "# Made by `diminish convert`.\n";
  if (!is_first || rig.rgbd.size() > 1) scene += "world_marker: {id: 0, size_m: 0.2}\n";
  scene += "occluders:\n  - name: object\n    detector: difference\n    clearance: 0.3\n";
  write_file(folder / "scene.yaml", scene);
}

}  // namespace diminish

#include <algorithm>
#include <system_error>

#include "diminish/error.h"
#include "setup/convert/convert.h"
#include "setup/convert/converted_recording.h"
#include "setup/convert/tum_format.h"
#include "sink/recording_folder.h"
#include "source/stream_list.h"

namespace diminish {
namespace {

/// The color stream's images are the user's view, too.
Conversion::Stream copy_stream(const std::filesystem::path& folder, const std::string& list,
                               const std::filesystem::path& recording, const std::string& name,
                               ConvertedStream* users_view) {
  ConvertedStream stream(recording, name);
  for (const StreamEntry& entry : load_stream_list(folder / list)) {
    const std::string file = entry.file.lexically_normal().string();
    if (entry.file.is_absolute() || file.starts_with("..")) {
      throw Error(Error::input,
                  (folder / list).string() + ": expected files in the folder, got " + file);
    }
    std::error_code ignored;
    if (!std::filesystem::exists(recording / file, ignored)) {
      copy_to(folder / file, recording / file);
    }
    stream.add_file(entry.stamp_s, file);
    if (users_view) users_view->add_file(entry.stamp_s, file);
  }
  return {name, list, stream.images()};
}

}  // namespace

bool is_tum_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::exists(folder / "rgb.txt", ignored) &&
         std::filesystem::exists(folder / "depth.txt", ignored);
}

Intrinsics tum_lens() {
  return {.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
}

Conversion convert_tum(const std::filesystem::path& folder, const std::filesystem::path& recording,
                       const Intrinsics& lens) {
  make_recording_folder(recording);
  Conversion conversion;
  ConvertedStream users_view(recording, "color");
  conversion.streams.push_back(
      copy_stream(folder, "rgb.txt", recording, "rgbd0_color", &users_view));
  conversion.streams.push_back(copy_stream(folder, "depth.txt", recording, "rgbd0_depth", nullptr));
  conversion.streams.insert(conversion.streams.begin(), {"color", "rgb.txt", users_view.images()});
  Rig rig;
  rig.color = lens;
  rig.rgbd.push_back({.name = "rgbd0", .color = lens, .depth = lens, .depth_unit_m = tum_unit_m});
  write_set_up(recording, rig, true, "");
  return conversion;
}

}  // namespace diminish

#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "diminish/image.h"
#include "diminish/rig.h"

namespace diminish {

/// A stream of a recording that is being made: its list and its images.
class ConvertedStream {
 public:
  /// name: "color", "rgbd0_color", "rgbd0_depth". Throws Error if it cannot be made.
  ConvertedStream(const std::filesystem::path& recording, const std::string& name);

  /// Adds an image, of which these are the file's bytes. False, and nothing is done, if its stamp
  /// is not above the last one's. extension: ".jpg".
  bool add(double stamp_s, std::string_view bytes, const char* extension);
  bool add(double stamp_s, const Image<Bgr>& image);            ///< as JPEG
  bool add(double stamp_s, const Image<std::uint16_t>& image);  ///< as PNG
  /// Adds an image that is there already, below the recording's folder.
  bool add_file(double stamp_s, const std::string& file);
  const std::string& last_file() const { return last_file_; }
  std::size_t images() const { return images_; }

 private:
  std::filesystem::path recording_;
  std::string folder_, last_file_;
  std::ofstream list_;
  double last_stamp_s_ = -1;
  std::size_t images_ = 0;
};

/// Writes rig.yaml, whose user's view is the first RGB-D camera's colour sensor if `is_first`, and
/// a scene.yaml that removes what stands free. notes: comments, one a line.
void write_set_up(const std::filesystem::path& folder, const Rig& rig, bool is_first,
                  const std::string& notes);

}  // namespace diminish

#pragma once

#include <cstddef>
#include <filesystem>
#include <istream>
#include <optional>
#include <string>
#include <vector>

namespace diminish {

/// One image of a stream: a file, or a frame of a video.
struct StreamEntry {
  double stamp_s = 0;
  std::filesystem::path file;  ///< as the list names it: relative to the list's folder
  std::optional<int> frame;    ///< in a video: which of its frames; 0 for the first
  int line = 0;                ///< of the list
};

/// What a list without entries means. The user's camera must have images; an RGB-D camera may have
/// delivered none.
enum class EmptyList { is_error, is_no_images };

/// Whether a file is a video, by its extension.
bool is_video(const std::filesystem::path& file);

/// Reads a "timestamp filename" list. Several lines that name the same video stand for its
/// consecutive frames. Throws Error with file and line on malformed lines, on timestamps that do
/// not increase and, if that is an error, on an empty list. A video that is named once has one
/// entry without `frame`; see `expand_videos`.
std::vector<StreamEntry> read_stream_list(std::istream& stream, const std::filesystem::path& file,
                                          EmptyList empty = EmptyList::is_error);

/// Replaces each entry that stands for a whole video by one entry per frame, at the video's frame
/// rate. `list` is the list's file. Throws Error on videos that cannot be opened or that overlap
/// the next entry's time.
std::vector<StreamEntry> expand_videos(const std::vector<StreamEntry>& entries,
                                       const std::filesystem::path& list);

/// Reads a list and expands its videos.
std::vector<StreamEntry> load_stream_list(const std::filesystem::path& list,
                                          EmptyList empty = EmptyList::is_error);

/// The image's name: its file's stem, or for a video's frame `index` with six digits.
std::string entry_name(const StreamEntry& entry, std::size_t index);

/// "rgbd0/depth/000003.png" or "rgbd0/depth.mkv frame 3"
std::string describe(const StreamEntry& entry);

/// The entry nearest in time (the earlier of two equally near); nothing if none is within
/// `tolerance_s`.
std::optional<std::size_t> nearest_entry(const std::vector<StreamEntry>& entries, double stamp_s,
                                         double tolerance_s);

/// The median time between entries; 1/30 s for fewer than two.
double median_period_s(const std::vector<StreamEntry>& entries);

}  // namespace diminish

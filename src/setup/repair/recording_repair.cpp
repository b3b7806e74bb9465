#include "setup/repair/recording_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>

#include "core/tasks.h"
#include "diminish/error.h"
#include "diminish/rig.h"
#include "sink/partial_file.h"
#include "source/image_file.h"
#include "source/stream_list.h"

namespace diminish {
namespace {

/// A line of a list: the entry, or why it cannot be used.
struct Line {
  std::string text;
  std::optional<StreamEntry> entry;
  std::string problem;
};

std::vector<Line> read_lines(const std::filesystem::path& list) {
  std::ifstream stream(list, std::ios::binary);
  if (!stream) {
    throw Error(Error::input, list.string() + ": cannot be read, expected a recording's list");
  }
  std::vector<Line> lines;
  for (std::string text; std::getline(stream, text);) {
    Line& line = lines.emplace_back();
    line.text = text;
    try {
      std::istringstream alone(text);
      const auto entries = read_stream_list(alone, "", EmptyList::is_no_images);
      if (!entries.empty()) line.entry = entries.front();
    } catch (const Error&) {
      line.problem = "expected a timestamp and a file's name";
    }
  }
  return lines;
}

/// What is wrong with the file that an entry names; empty: nothing. Videos are not looked into.
template <class Pixel>
std::string problem_of(const std::filesystem::path& folder, const StreamEntry& entry,
                       const Intrinsics& camera) {
  try {
    const auto bytes = read_bytes(folder / entry.file);
    if (!is_video(entry.file)) expect_format<Pixel>(decode<Pixel>(bytes), camera);
  } catch (const Error& error) {
    return entry.file.string() + ": " + error.what();
  }
  return "";
}

template <class Pixel>
ListRepair repair_list(const std::filesystem::path& folder, const std::string& name,
                       const Intrinsics& camera) {
  const std::filesystem::path list = folder / name;
  std::vector<Line> lines = read_lines(list);
  for_tasks(lines.size(), [&](std::size_t i) {
    if (lines[i].entry) lines[i].problem = problem_of<Pixel>(folder, *lines[i].entry, camera);
  });
  ListRepair repair{name};
  std::string kept;
  double last_stamp_s = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    Line& line = lines[i];
    const bool is_entry = line.entry && line.problem.empty();
    const bool is_video_again = is_entry && is_video(line.entry->file);
    if (is_entry && !(line.entry->stamp_s > last_stamp_s) && !is_video_again) {
      line.problem = fmt::format("expected a timestamp after {:.6f}", last_stamp_s);
    }
    if (!line.problem.empty()) {
      repair.left_out.push_back(fmt::format("line {}: {}", i + 1, line.problem));
      continue;
    }
    kept += line.text + '\n';
    if (!is_entry) continue;  // a comment
    last_stamp_s = line.entry->stamp_s;
    ++repair.kept;
  }
  if (repair.left_out.empty()) return repair;
  const std::filesystem::path before = folder / (name + ".before");
  std::error_code error;
  // Of several repairs the first knows what the recorder wrote.
  if (!std::filesystem::exists(before, error)) std::filesystem::copy_file(list, before, error);
  if (error) throw Error(Error::io, before.string() + ": cannot be written: " + error.message());
  write_file(list, kept);
  return repair;
}

std::vector<std::filesystem::path> delete_partial_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error)) {
    if (is_partial_file(entry.path())) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  for (const std::filesystem::path& file : found) std::filesystem::remove(file, error);
  return found;
}

}  // namespace

bool RecordingRepair::was_needed() const {
  return !deleted.empty() || std::any_of(lists.begin(), lists.end(), [](const ListRepair& list) {
    return !list.left_out.empty();
  });
}

RecordingRepair repair_recording(const std::filesystem::path& folder) {
  const Rig rig = load_rig(folder / "rig.yaml");
  RecordingRepair repair;
  repair.deleted = delete_partial_files(folder);
  repair.lists.push_back(repair_list<Bgr>(folder, "color.txt", rig.color));
  if (repair.lists.front().kept == 0) {
    throw Error(Error::input, (folder / "color.txt").string() + ": none of its images can be read");
  }
  for (const RgbdCamera& camera : rig.rgbd) {
    repair.lists.push_back(repair_list<Bgr>(folder, camera.name + "_color.txt", camera.color));
    if (!camera.measures_depth) continue;
    repair.lists.push_back(
        repair_list<std::uint16_t>(folder, camera.name + "_depth.txt", camera.depth));
  }
  return repair;
}

}  // namespace diminish

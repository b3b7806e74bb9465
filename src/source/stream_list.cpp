#include "source/stream_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>

#include "core/robust.h"
#include "core/text.h"
#include "diminish/error.h"
#include "source/video_reader.h"

namespace diminish {
namespace {

constexpr std::size_t max_list_bytes = 256 << 20;

[[noreturn]] void fail(const std::filesystem::path& list, int line, const std::string& message) {
  throw Error(Error::input, fmt::format("{}:{}: {}", list.string(), line, message));
}

std::string_view trim(std::string_view text) {
  constexpr const char* white = " \t\r";
  const std::size_t begin = text.find_first_not_of(white);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(white) - begin + 1);
}

StreamEntry read_entry(std::string_view text, int line, const std::filesystem::path& list) {
  const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
  const auto stamp = parse_number(text.substr(0, end));
  if (!stamp) {
    fail(list, line, "expected a timestamp, got '" + printable(text.substr(0, end)) + "'");
  }
  // The rest of the line, because names may contain spaces.
  const std::string_view name = trim(text.substr(end));
  if (name.empty()) fail(list, line, "expected a file's name after the timestamp");
  const auto is_control = [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; };
  if (std::any_of(name.begin(), name.end(), is_control)) {
    fail(list, line, "expected a file's name, got '" + printable(name) + "'");
  }
  return {*stamp, std::filesystem::path(name), std::nullopt, line};
}

void expect_increasing(const std::vector<StreamEntry>& entries, const std::filesystem::path& list) {
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (entries[i].stamp_s > entries[i - 1].stamp_s) continue;
    fail(list, entries[i].line,
         fmt::format("expected a timestamp after {:.6f}, got {:.6f}", entries[i - 1].stamp_s,
                     entries[i].stamp_s));
  }
}

/// Numbers the frames of videos that are named more than once.
void number_frames(std::vector<StreamEntry>& entries) {
  std::map<std::filesystem::path, int> lines;
  for (const StreamEntry& entry : entries) {
    if (is_video(entry.file)) ++lines[entry.file];
  }
  std::map<std::filesystem::path, int> next;
  for (StreamEntry& entry : entries) {
    if (is_video(entry.file) && lines[entry.file] > 1) entry.frame = next[entry.file]++;
  }
}

}  // namespace

bool is_video(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* video : {".avi", ".mkv", ".mov", ".mp4", ".webm"}) {
    if (extension == video) return true;
  }
  return false;
}

std::vector<StreamEntry> read_stream_list(std::istream& stream, const std::filesystem::path& file,
                                          EmptyList empty) {
  std::vector<StreamEntry> entries;
  int line = 0;
  for (std::string text; std::getline(stream, text);) {
    ++line;
    const std::string_view content = trim(text);
    if (content.empty() || content.front() == '#') continue;
    entries.push_back(read_entry(content, line, file));
  }
  if (entries.empty() && empty == EmptyList::is_error) {
    throw Error(Error::input,
                file.string() + ": expected at least one line of \"timestamp filename\"");
  }
  expect_increasing(entries, file);
  number_frames(entries);
  return entries;
}

std::vector<StreamEntry> expand_videos(const std::vector<StreamEntry>& entries,
                                       const std::filesystem::path& list) {
  std::vector<StreamEntry> expanded;
  for (const StreamEntry& entry : entries) {
    if (!is_video(entry.file) || entry.frame) {
      expanded.push_back(entry);
      continue;
    }
    const VideoLength length = measure_video(list.parent_path() / entry.file);
    for (int frame = 0; frame < length.frames; ++frame) {
      const double stamp_s = entry.stamp_s + frame / length.frames_per_second;
      expanded.push_back({stamp_s, entry.file, frame, entry.line});
    }
  }
  expect_increasing(expanded, list);
  return expanded;
}

std::vector<StreamEntry> load_stream_list(const std::filesystem::path& list, EmptyList empty) {
  std::istringstream stream(read_text_file(list, max_list_bytes));
  return expand_videos(read_stream_list(stream, list, empty), list);
}

std::string entry_name(const StreamEntry& entry, std::size_t index) {
  return entry.frame ? fmt::format("{:06}", index) : entry.file.stem().string();
}

std::string describe(const StreamEntry& entry) {
  if (!entry.frame) return entry.file.string();
  return fmt::format("{} frame {}", entry.file.string(), *entry.frame);
}

std::optional<std::size_t> nearest_entry(const std::vector<StreamEntry>& entries, double stamp_s,
                                         double tolerance_s) {
  const auto distance = [&](std::size_t i) { return std::abs(entries[i].stamp_s - stamp_s); };
  const auto after =
      std::partition_point(entries.begin(), entries.end(),
                           [&](const StreamEntry& entry) { return entry.stamp_s < stamp_s; });
  auto nearest = static_cast<std::size_t>(after - entries.begin());
  if (nearest == entries.size() || (nearest > 0 && distance(nearest - 1) <= distance(nearest))) {
    if (nearest == 0) return std::nullopt;
    --nearest;
  }
  // Timestamps have microseconds and are not exact as binary fractions.
  constexpr double rounding_s = 1e-6;
  if (!(distance(nearest) <= tolerance_s + rounding_s)) return std::nullopt;
  return nearest;
}

double median_period_s(const std::vector<StreamEntry>& entries) {
  if (entries.size() < 2) return 1.0 / 30;
  std::vector<double> periods;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    periods.push_back(entries[i].stamp_s - entries[i - 1].stamp_s);
  }
  return median(periods);
}

}  // namespace diminish

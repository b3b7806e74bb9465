#include "sink/frames_csv.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "diminish/error.h"
#include "sink/time_table.h"

namespace diminish {
namespace {

std::string in_quotes(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

std::string joined(const std::vector<std::string>& texts) {
  std::string result;
  for (const std::string& text : texts) result += (result.empty() ? "" : "; ") + text;
  return in_quotes(result);
}

std::string pose_columns(const std::string& name) {
  std::string columns;
  for (const char* part : {"tx", "ty", "tz", "qx", "qy", "qz", "qw"}) {
    columns += "," + in_quotes(name + "_" + part);
  }
  return columns;
}

std::string pose_values(const std::optional<RigidTransform>& pose) {
  if (!pose) return ",,,,,,,";
  const Eigen::Quaterniond q(pose->rotation);
  const Eigen::Vector3d& t = pose->translation;
  return fmt::format(",{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", t.x(), t.y(), t.z(),
                     q.x(), q.y(), q.z(), q.w());
}

std::string marker_ids(const std::vector<Marker>& markers) {
  std::string ids;
  for (const Marker& marker : markers) ids += (ids.empty() ? "" : " ") + std::to_string(marker.id);
  return ids;
}

std::string ages(const FrameReport& report) {
  if (report.remembered_pixels <= report.memory.background_pixels) return ",,";
  return fmt::format(",{:.3f},{:.3f}", report.memory.median_age_s, report.memory.oldest_age_s);
}

/// "calendar: color rgbd0" for each occluder, in quotes.
std::string found_occluders(const std::vector<OccluderReport>& occluders,
                            const std::vector<std::string>& cameras) {
  std::vector<std::string> texts;
  for (const OccluderReport& occluder : occluders) {
    std::string text = occluder.name + ":";
    if (occluder.in_color) text += " color";
    for (std::size_t k = 0; k < occluder.in_rgbd.size(); ++k) {
      if (occluder.in_rgbd[k]) text += " " + cameras[k];
    }
    texts.push_back(text);
  }
  return joined(texts);
}

}  // namespace

FramesCsv::FramesCsv(const std::filesystem::path& file, const Rig& rig)
    : file_(file), stream_(file, std::ios::binary) {
  for (const RgbdCamera& camera : rig.rgbd) cameras_.push_back(camera.name);
  std::string header = "name,stamp_s,skipped,color_markers";
  for (const RgbdCamera& camera : rig.rgbd) header += "," + in_quotes(camera.name + "_markers");
  header += pose_columns("color_from_world");
  for (const RgbdCamera& camera : rig.rgbd) {
    header += pose_columns(camera.name + "_depth_from_world");
    header += pose_columns("color_from_" + camera.name + "_depth");
  }
  header += ",occluders,mask_pixels,valid_pixels,missing_pixels,witnessed_pixels,remembered_pixels";
  for (const RgbdCamera& camera : rig.rgbd) header += "," + in_quotes(camera.name + "_fit");
  header += ",in_doubt,background_pixels,remembered_median_age_s,remembered_oldest_age_s,keyframes";
  header += ",estimated_pixels";
  for (const TimeRow& row : time_rows()) header += fmt::format(",{}_ms", row.key);
  header += ",messages,faults\n";
  stream_ << header << std::flush;
  if (!stream_) throw Error(Error::io, file_.string() + ": cannot be written");
}

void FramesCsv::append(const DiminishedFrame& frame) {
  const FrameReport& report = frame.report;
  const bool known = !report.skipped;
  std::string row =
      fmt::format("{},{:.6f},{},{}", in_quotes(frame.name), frame.stamp_s, report.skipped ? 1 : 0,
                  known ? marker_ids(report.markers.color) : "");
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    row += "," + (known ? marker_ids(report.markers.rgbd[k]) : "");
  }
  row += pose_values(known ? report.poses.color_from_world : std::nullopt);
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    row += pose_values(known ? report.poses.depth_from_world[k] : std::nullopt);
    row += pose_values(known ? report.poses.color_from_depth[k] : std::nullopt);
  }
  row += fmt::format(",{},{},{},{},{},{}",
                     known ? found_occluders(report.occluders, cameras_) : in_quotes(""),
                     report.mask_pixels, report.valid_pixels, report.missing_pixels,
                     report.witnessed_pixels, report.remembered_pixels);
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    row += k < report.fit.size() && report.fit[k] ? fmt::format(",{:.3f}", *report.fit[k]) : ",";
  }
  row += fmt::format(",{}", report.in_doubt ? 1 : 0);
  row += fmt::format(",{}", report.memory.background_pixels) + ages(report) +
         fmt::format(",{},{}", report.memory.keyframes, report.estimated_pixels);
  for (const double ms : times_of(report)) row += fmt::format(",{:.3f}", ms);
  row += fmt::format(",{},{}\n", joined(report.messages), joined(report.faults));
  // One write per row, so that an interrupted run leaves whole rows.
  stream_ << row << std::flush;
  if (!stream_) throw Error(Error::io, file_.string() + ": cannot be written");
}

}  // namespace diminish

#include "setup/check/setup_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/mat.h"
#include "pose/aruco.h"
#include "setup/check/flipped.h"

namespace diminish {
namespace {

using Severity = Finding::Severity;

constexpr double small_marker_px = 40;
/// Of the frames: a camera whose world marker is seen in fewer is missed.
constexpr double least_share = 0.9;

bool sees_known_markers(const SensorSurvey& sensor) {
  return !sensor.markers.empty();
}

bool check_mirrored(Diagnosis& setup, std::size_t sensor) {
  MarkerDetector detector(setup.scene.marker_dictionary);
  const Lens lens(color_sensor(setup.rig, sensor));
  std::vector<Marker> markers;
  std::size_t found = 0;
  std::size_t images = 0;
  for (const SetupSurvey::Kept& kept : setup.survey.kept) {
    if (image_of(kept, sensor).empty()) continue;
    ++images;
    detector.detect(flipped(image_of(kept, sensor)), lens, markers);
    const bool known = std::any_of(markers.begin(), markers.end(), [&](const Marker& marker) {
      return setup.sizes.count(marker.id) > 0;
    });
    found += known ? 1 : 0;
  }
  if (found == 0 || 2 * found < images) return false;
  setup.find(
      Severity::serious, "mirrored", setup.sensors()[sensor]->name + " is mirrored",
      fmt::format("markers are found in {} of {} images, but only when these are flipped left "
                  "to right",
                  found, images),
      "switch off mirroring in the driver; for an RGB-D camera also check the depth images");
  return true;
}

/// Looks for markers of other dictionaries where none of the configured one was found.
bool check_dictionary(Diagnosis& setup) {
  std::string best;
  std::size_t best_score = 0;
  std::string ids;
  for (const std::string& name : dictionary_names()) {
    MarkerDetector detector(name);
    std::map<int, std::size_t> seen;
    for (const SetupSurvey::Kept& kept : setup.survey.kept) {
      for (std::size_t s = 0; s <= setup.rig.rgbd.size(); ++s) {
        if (image_of(kept, s).empty()) continue;
        const Lens lens(color_sensor(setup.rig, s));
        std::vector<Marker> markers;
        detector.detect(image_of(kept, s), lens, markers);
        for (const Marker& marker : markers) ++seen[marker.id];
      }
    }
    // Real markers show up repeatedly; expected ids count double.
    std::size_t score = 0;
    std::string list;
    for (const auto& [id, count] : seen) {
      if (count < 2) continue;
      score += count * (setup.sizes.count(id) > 0 ? 2 : 1);
      list += (list.empty() ? "" : ", ") + std::to_string(id);
    }
    if (score <= best_score) continue;
    best_score = score;
    best = name;
    ids = list;
  }
  if (best.empty() || best == setup.scene.marker_dictionary) return false;
  setup.find(Severity::serious, "dictionary",
             fmt::format("the markers belong to another dictionary: {}", best),
             fmt::format("none of {} is found, but of {} ids {}", setup.scene.marker_dictionary,
                         best, ids),
             fmt::format("marker_dictionary: {} in scene.yaml", best));
  return true;
}

/// Finds markers that are too small for our detector but not for OpenCV's, which is slow.
bool check_too_small(Diagnosis& setup, const SensorSurvey& sensor, std::size_t index, int id) {
  std::vector<double> sides;
  for (const SetupSurvey::Kept& kept : setup.survey.kept) {
    if (image_of(kept, index).empty()) continue;
    for (const Marker& marker :
         detect_with_opencv(as_mat(image_of(kept, index)), setup.scene.marker_dictionary)) {
      if (marker.id == id) sides.push_back(mean_side_px(marker));
    }
  }
  if (sides.empty()) return false;
  setup.find(
      Severity::serious, "marker-small",
      fmt::format("world marker {} is too small in {}", id, sensor.name),
      fmt::format("{:.0f} pixels; expected at least {:.0f}", median_of(sides), small_marker_px),
      "print it larger or bring it nearer");
  return true;
}

void check_world_marker(Diagnosis& setup, const SensorSurvey& sensor, std::size_t index) {
  const int id = setup.scene.world_marker.id;
  const auto statistics = sensor.markers.find(id);
  const std::size_t count = statistics == sensor.markers.end() ? 0 : statistics->second.count;
  setup.note(fmt::format("{}: frames with the world marker", sensor.name),
             static_cast<double>(count), "");
  if (static_cast<double>(count) >= least_share * static_cast<double>(sensor.images)) return;
  if (count == 0) {
    setup.mark_unusable(index);
    if (check_too_small(setup, sensor, index, id)) return;
  }
  setup.find(
      count == 0 ? Severity::serious : Severity::warning, "marker-not-visible",
      fmt::format("world marker {} is {} visible in {}", id, count == 0 ? "never" : "not always",
                  sensor.name),
      fmt::format("{} of {} frames", count, sensor.images),
      "turn the camera or move the marker until every camera sees all of it; check its id and "
      "its white rim");
}

void check_marker_sizes(Diagnosis& setup, const SensorSurvey& sensor) {
  for (const auto& [id, statistics] : sensor.markers) {
    const double side = median_of(statistics.sides_px);
    setup.note(fmt::format("{}: side of marker {}", sensor.name, id), side, "pixels");
    setup.note(fmt::format("{}: reprojection error of marker {}", sensor.name, id),
               median_of(statistics.errors_px), "pixels");
    if (side >= small_marker_px) continue;
    setup.find(Severity::warning, "marker-small",
               fmt::format("marker {} is small in {}", id, sensor.name),
               fmt::format("{:.0f} pixels; expected at least {:.0f}", side, small_marker_px),
               "print it larger or bring it nearer");
  }
}

}  // namespace

void check_markers(Diagnosis& setup) {
  const int world = setup.scene.world_marker.id;
  const bool has_world = setup.scene.world_marker.size_m > 0;
  const bool needs_world = has_world && setup.rig.pose_source == "marker";
  const bool only_world = has_world && setup.sizes.size() == 1;
  if (setup.sizes.empty() || (only_world && !needs_world)) return;
  const auto all = setup.sensors();
  const bool any = std::any_of(all.begin(), all.end(), [&](const SensorSurvey* sensor) {
    return sees_known_markers(*sensor);
  });
  std::set<std::size_t> mirrored;
  for (std::size_t s = 0; s < all.size(); ++s) {
    if (all[s]->images == 0 || sees_known_markers(*all[s]) || !check_mirrored(setup, s)) continue;
    mirrored.insert(s);
    setup.mark_unusable(s);
  }
  if (!any && mirrored.empty()) {
    for (std::size_t s = 0; s < all.size(); ++s) setup.mark_unusable(s);
    if (check_dictionary(setup)) return;
  }
  for (std::size_t s = 0; s < all.size(); ++s) {
    if (all[s]->images == 0 || mirrored.count(s) > 0) continue;
    if (needs_world) check_world_marker(setup, *all[s], s);
    check_marker_sizes(setup, *all[s]);
  }
  for (const auto& [id, size] : setup.sizes) {
    if (has_world && id == world) continue;
    const bool seen = std::any_of(all.begin(), all.end(), [&, marker = id](const auto* sensor) {
      return sensor->markers.count(marker) > 0;
    });
    if (seen || !mirrored.empty()) continue;
    setup.find(Severity::serious, "marker-not-visible",
               fmt::format("marker {} is never visible in any camera", id),
               fmt::format("0 of {} frames", setup.survey.frames),
               "check its id, that it is whole and in view, and its white rim");
  }
}

}  // namespace diminish
